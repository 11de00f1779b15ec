#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A Modbus device that misbehaves on command, over TCP or RTU, frames made by hand.

usage: faulty_server.py tcp|rtu
Says 'port N' or 'line PATH', then takes a line 'MODE [NUMBER]' and says 'ok'. The register at address A holds
1000 + A. Modes, until the next:
  good        answers
  silent      does not
  shift       answers each request with the answer to the one before
  late        keeps the next answer back, and sends it before the answer that follows; then good
  half        sends half an answer
  unit N      as unit N
  function    to another function
  longer      with one register more than was asked for
  address     a write as one to the next address
  exception N
  number      TCP: with a transaction number of no request
  envelope    TCP: with a protocol that is not Modbus
  checksum    RTU: a wrong one"""
import os
import select
import socket
import struct
import sys
import tty


def crc(frame):
    value = 0xFFFF
    for byte in frame:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ (0xA001 if value & 1 else 0)
    return struct.pack("<H", value)


class Device:
    def __init__(self):
        self.mode, self.number, self.held = "good", 0, []

    def answer(self, pdu):
        function, address, count = struct.unpack(">BHH", pdu[:5])
        if self.mode == "function":
            return bytes([function ^ 7, 2, 0, 1])
        if self.mode == "exception":
            return bytes([function | 0x80, self.number])
        if function in (3, 4):
            count += self.mode == "longer"
            return struct.pack(">BB", function, 2 * count) + b"".join(
                struct.pack(">H", 1000 + address + i & 0xFFFF) for i in range(count))
        if function in (6, 16):
            return struct.pack(">BHH", function, address + (self.mode == "address"), count)
        return pdu if function == 8 else bytes([function | 0x80, 1])

    def frames(self, request, enclose):
        """What is sent upon a request (unit and PDU)."""
        unit = self.number if self.mode == "unit" else request[0]
        frame = enclose(bytes([unit]) + self.answer(request[1:]))
        if self.mode == "silent":
            return b""
        if self.mode == "half":
            return frame[:len(frame) // 2]
        if self.mode in ("shift", "late"):
            self.held.append(frame)
            if len(self.held) == 1:
                return b""
            if self.mode == "shift":
                return self.held.pop(0)
            self.mode = "good"
        frame = b"".join(self.held) + frame if not self.held or self.held[-1] is not frame else b"".join(self.held)
        self.held = []
        return frame

    def command(self):
        line = sys.stdin.readline().split()
        if not line:
            sys.exit(0)
        self.mode, self.number = line[0], int(line[1]) if len(line) > 1 else 0
        self.held = []
        print("ok", flush=True)


def serve_tcp(device):
    listener = socket.create_server(("127.0.0.1", 0))
    print("port", listener.getsockname()[1], flush=True)
    clients = {}
    while True:
        for ready in select.select([sys.stdin, listener, *clients], [], [])[0]:
            if ready is sys.stdin:
                device.command()
            elif ready is listener:
                clients[listener.accept()[0]] = b""
            else:
                data = ready.recv(1000)
                if not data:
                    del clients[ready]
                    device.held = []
                    continue
                clients[ready] += data
                while len(clients[ready]) >= 6:
                    length = 6 + struct.unpack(">H", clients[ready][4:6])[0]
                    if len(clients[ready]) < length:
                        break
                    request, clients[ready] = clients[ready][:length], clients[ready][length:]
                    number = (struct.unpack(">H", request[:2])[0] + 5 * (device.mode == "number")) & 0xFFFF
                    protocol = 7 if device.mode == "envelope" else 0
                    ready.sendall(device.frames(request[6:], lambda adu, n=number, p=protocol:
                                                struct.pack(">HHH", n, p, len(adu)) + adu))


def serve_rtu(device):
    ours, theirs = os.openpty()
    tty.setraw(theirs)
    print("line", os.ttyname(theirs), flush=True)
    data = b""
    while True:
        for ready in select.select([sys.stdin, ours], [], [])[0]:
            if ready is sys.stdin:
                device.command()
                continue
            data += os.read(ours, 1000)
            while len(data) >= 8:
                length = 9 + data[6] if data[1] in (15, 16) else 8
                if len(data) < length:
                    break
                frame, data = data[:length], data[length:]
                assert crc(frame[:-2]) == frame[-2:], frame
                os.write(ours, device.frames(frame[:-2], lambda adu: adu + (
                    b"\0\0" if device.mode == "checksum" else crc(adu))))


{"tcp": serve_tcp, "rtu": serve_rtu}[sys.argv[1]](Device())
