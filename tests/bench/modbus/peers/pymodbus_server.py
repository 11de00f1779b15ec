#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""pymodbus's server over TCP or RTU, whose tables are filled and read by lines:

  set TABLE ADDRESS TYPE WORDS BYTES VALUE    says 'ok'
  get TABLE ADDRESS TYPE WORDS BYTES          says the value

TABLE holding, input, coil or discrete; TYPE int16 … float32 or bit; WORDS, BYTES: high or low first. Numbers are
packed by Python's struct.

usage: pymodbus_server.py tcp | rtu PATH        says 'port N' or 'line PATH' first, or why it cannot"""
import asyncio
import struct
import sys

try:
    from pymodbus.datastore import ModbusSequentialDataBlock, ModbusServerContext, ModbusSlaveContext
    from pymodbus.server.async_io import ModbusSerialServer, ModbusTcpServer
    from pymodbus.transaction import ModbusRtuFramer
except ImportError as missing:
    print(f"/usr/bin/python3 has no {missing.name}", flush=True)
    sys.exit(77)

FORMATS = {"int16": ">h", "uint16": ">H", "int32": ">i", "uint32": ">I", "float32": ">f"}
FUNCTIONS = {"coil": 1, "discrete": 2, "holding": 3, "input": 4}
STORE = ModbusSlaveContext(**{table: ModbusSequentialDataBlock(0, [0] * 200) for table in ("di", "co", "ir", "hr")},
                           zero_mode=True)


def reorder(data, words, byte_order):
    pairs = [data[i:i + 2] for i in range(0, len(data), 2)]
    pairs = pairs if words == "high" else pairs[::-1]
    return b"".join(pair if byte_order == "high" else pair[::-1] for pair in pairs)


def command(line):
    verb, table, address, kind, *rest = line.split()
    function, address = FUNCTIONS[table], int(address)
    if kind == "bit":
        if verb == "set":
            STORE.setValues(function, address, [rest[2] == "1"])
            return "ok"
        return str(int(STORE.getValues(function, address, 1)[0]))
    words, byte_order, *value = rest
    if verb == "set":
        data = struct.pack(FORMATS[kind], (float if kind == "float32" else int)(value[0]))
        data = reorder(data, words, byte_order)
        STORE.setValues(function, address, list(struct.unpack(f">{len(data) // 2}H", data)))
        return "ok"
    count = struct.calcsize(FORMATS[kind]) // 2
    data = struct.pack(f">{count}H", *STORE.getValues(function, address, count))
    return repr(struct.unpack(FORMATS[kind], reorder(data, words, byte_order))[0])


async def main():
    context = ModbusServerContext(slaves={1: STORE}, single=False)
    if sys.argv[1] == "tcp":
        server = ModbusTcpServer(context, address=("127.0.0.1", 0))
        asyncio.ensure_future(server.serve_forever())
        await server.serving
        print("port", server.server.sockets[0].getsockname()[1], flush=True)
    else:
        # A pseudo terminal keeps no parity.
        server = ModbusSerialServer(context, framer=ModbusRtuFramer, port=sys.argv[2], baudrate=19200, parity="N")
        await server.start()
        print("line", sys.argv[2], flush=True)
    loop = asyncio.get_running_loop()
    while line := await loop.run_in_executor(None, sys.stdin.readline):
        print(command(line), flush=True)


asyncio.run(main())
