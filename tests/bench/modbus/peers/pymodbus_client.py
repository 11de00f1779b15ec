#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""pymodbus's client, which asks a device what the test's lines say:

  read TABLE ADDRESS COUNT          says the numbers, or 'exception N'
  write TABLE ADDRESS NUMBER…       says 'ok' or 'exception N'

usage: pymodbus_client.py tcp PORT | rtu PATH        says 'line ' and where it is connected to, or why it cannot"""
import sys

try:
    from pymodbus.client import ModbusSerialClient, ModbusTcpClient
except ImportError as missing:
    print(f"/usr/bin/python3 has no {missing.name}", flush=True)
    sys.exit(77)

kind, where = sys.argv[1:]
client = (ModbusTcpClient("127.0.0.1", port=int(where)) if kind == "tcp" else
          ModbusSerialClient(where, baudrate=19200, parity="N"))
if not client.connect():
    sys.exit(f"no connection to {where}")
print("line", where, flush=True)
READ = {"coil": client.read_coils, "discrete": client.read_discrete_inputs, "holding": client.read_holding_registers,
        "input": client.read_input_registers}
for line in sys.stdin:
    verb, table, address, *numbers = line.split()
    address, numbers = int(address), list(map(int, numbers))
    if verb == "read":
        answer = READ[table](address, numbers[0], slave=1)
    elif table == "coil":
        answer = (client.write_coil(address, numbers[0] == 1, slave=1) if len(numbers) == 1 else
                  client.write_coils(address, [number == 1 for number in numbers], slave=1))
    else:
        answer = (client.write_register(address, numbers[0], slave=1) if len(numbers) == 1 else
                  client.write_registers(address, numbers, slave=1))
    if answer.isError():
        print("exception", getattr(answer, "exception_code", answer), flush=True)
    elif verb == "write":
        print("ok", flush=True)
    else:
        values = answer.bits[:numbers[0]] if table in ("coil", "discrete") else answer.registers
        print(*map(int, values), flush=True)
