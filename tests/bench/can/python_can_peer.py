#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A master that is not ours against our drive: python3-can, every SDO frame by hand from CiA 301.

usage: python_can_peer.py PROGRAM EDS [INTERFACE]   (PROGRAM is drive_on_can)
"""
import binascii
import struct
import subprocess
import sys
import time

try:
    import can
except ImportError:
    print("python_can_peer.py: python3-can is missing (expected the packages of setup.sh)")
    sys.exit(77)

# The virtual machine is many times slower; none of these is a limit on our drive's speed.
PATIENCE_S = 20.0


class Master:
    def __init__(self, interface):
        self.bus = can.Bus(interface="socketcan", channel=interface)
        self.passed = []  # what went by while something else was waited for

    def send(self, identifier, data):
        self.bus.send(can.Message(arbitration_id=identifier, data=data, is_extended_id=False))

    def wait_for(self, identifier, accept=lambda data: True):
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            message = self.bus.recv(1.0)
            if message is None:
                continue
            if message.arbitration_id == identifier and accept(bytes(message.data)):
                return bytes(message.data)
            self.passed.append((message.arbitration_id, bytes(message.data)))
        raise AssertionError(f"no frame {identifier:X}; heard {self.passed[-20:]}")

    def ask(self, *request):
        self.send(0x601, bytes(request).ljust(8, b"\0"))
        return self.wait_for(0x581)

    def upload(self, index, sub):
        """Expedited or in segments, whichever the drive takes."""
        answer = self.ask(0x40, index & 0xFF, index >> 8, sub)
        assert answer[1:4] == struct.pack("<HB", index, sub), answer.hex()
        if answer[0] & 0x02:
            return answer[4 : 8 - (answer[0] >> 2 & 3)]
        assert answer[0] == 0x41, answer.hex()
        size = struct.unpack("<I", answer[4:])[0]
        data, toggle = b"", 0
        while True:
            answer = self.ask(0x60 | toggle)
            assert answer[0] & 0x10 == toggle, answer.hex()
            data += answer[1 : 8 - (answer[0] >> 1 & 7)]
            toggle ^= 0x10
            if answer[0] & 1:
                break
        assert len(data) == size, (size, data)
        return data

    def download(self, index, sub, form, value):
        data = struct.pack("<" + form, value)
        answer = self.ask(0x23 | (4 - len(data)) << 2, index & 0xFF, index >> 8, sub, *data)
        return None if answer[0] == 0x60 else struct.unpack("<I", answer[4:])[0]

    def block_download(self, index, sub, data):
        answer = self.ask(0xC6, index & 0xFF, index >> 8, sub, *struct.pack("<I", len(data)))
        assert answer[0] == 0xA4, answer.hex()
        size, sent = answer[4], 0
        while sent < len(data):
            for number in range(1, size + 1):
                part, sent = data[sent : sent + 7], sent + 7
                last = sent >= len(data)
                self.send(0x601, bytes([number | (0x80 if last else 0)]) + part.ljust(7, b"\0"))
                if last:
                    break
            answer = self.wait_for(0x581)
            assert answer[:2] == bytes([0xA2, number]), (number, answer.hex())
        unused = -len(data) % 7
        answer = self.ask(0xC1 | unused << 2, *struct.pack("<H", binascii.crc_hqx(data, 0)))
        assert answer[0] == 0xA1, answer.hex()

    def block_upload(self, index, sub):
        answer = self.ask(0xA4, index & 0xFF, index >> 8, sub, 64, 0)
        assert answer[0] == 0xC6, answer.hex()
        size = struct.unpack("<I", answer[4:])[0]
        self.send(0x601, b"\xA3" + bytes(7))
        data, last = b"", False
        while not last:
            for number in range(1, 65):
                part = self.wait_for(0x581)
                assert part[0] & 0x7F == number, (number, part.hex())
                data += part[1:]
                last = bool(part[0] & 0x80)
                if last:
                    break
            self.send(0x601, bytes([0xA2, number, 64]) + bytes(5))
        end = self.wait_for(0x581)
        assert end[0] & 0xE3 == 0xC1, end.hex()
        data = data[: len(data) - (end[0] >> 2 & 7)]
        assert struct.unpack("<H", end[1:3])[0] == binascii.crc_hqx(data, 0)
        self.send(0x601, b"\xA1" + bytes(7))
        assert len(data) == size
        return data


def identity_and_transfers(master):
    assert master.upload(0x1000, 0) == struct.pack("<I", 0x00020192)
    assert master.upload(0x1018, 1) == struct.pack("<I", 0x5357)
    assert master.upload(0x1018, 2) == struct.pack("<I", 0x402)
    assert master.upload(0x1008, 0) == b"Strainwave servo"
    assert master.download(0x1000, 0, "I", 1) == 0x06010002
    assert master.download(0x6072, 0, "H", 3001) == 0x06090031
    assert master.ask(0x40, 0x99, 0x20)[0:8] == bytes.fromhex("8099200000000206")
    text = bytes(i * i % 251 for i in range(3000))
    master.block_download(0x2000, 0, text)
    assert master.block_upload(0x2000, 0) == text
    assert master.upload(0x2000, 0) == text
    print("identity, expedited, segmented and block transfer: as CiA 301 has them")


def heartbeat_and_nmt(master):
    assert master.download(0x1017, 0, "H", 100) is None
    assert master.wait_for(0x701) == b"\x7F"
    master.send(0, [1, 1])
    assert master.wait_for(0x701, lambda data: data != b"\x7F") == b"\x05"
    print("heartbeat: pre-operational, then operational")


def mapping(master):
    assert master.download(0x1A01, 0, "B", 0) is None  # it is off from the start
    assert master.download(0x1A01, 1, "I", 0x60410010) is None
    assert master.download(0x1A01, 2, "I", 0x606C0020) is None
    assert master.download(0x1A01, 0, "B", 2) is None
    assert master.download(0x1801, 2, "B", 1) is None
    assert master.download(0x1801, 1, "I", 0x40000281) is None
    assert master.download(0x1A01, 0, "B", 0) == 0x08000022  # now it is on
    master.send(0x80, [])
    assert len(master.wait_for(0x281)) == 6
    print("TPDO 2: mapped, answers SYNC, its mapping is held while it is on")


def motion(master):
    assert master.download(0x6060, 0, "b", 3) is None
    for word, state in ((0x06, 0x21), (0x07, 0x23), (0x0F, 0x27)):
        master.send(0x201, struct.pack("<H", word))
        master.wait_for(0x181, lambda data, state=state: data[0] & 0x6F == state)
    assert master.download(0x60FF, 0, "i", 327680) is None
    master.wait_for(0x181, lambda data: data[1] & 0x04)  # target reached
    master.send(0x80, [])
    assert struct.unpack("<Hi", master.wait_for(0x281))[1] == 327680
    master.send(0x201, struct.pack("<H", 0x02))  # quick stop
    master.wait_for(0x181, lambda data: data[0] & 0x4F == 0x40)
    print("profile velocity: enabled, at speed, quick stop")


def silence(master):
    assert master.download(0x1016, 1, "I", 0x007F0000 | 500) is None
    master.send(0x77F, [5])
    for word in (0x06, 0x07, 0x0F):
        master.send(0x201, struct.pack("<H", word))
    master.wait_for(0x181, lambda data: data[0] & 0x6F == 0x27)
    emergency = master.wait_for(0x081)
    assert emergency == bytes.fromhex("3081110000000000"), emergency.hex()
    assert master.wait_for(0x701, lambda data: data != b"\x05") == b"\x7F"
    assert master.upload(0x603F, 0) == struct.pack("<H", 0x8130)
    print("the master's heartbeat stays away: EMCY 8130, pre-operational, fault")


def main():
    if len(sys.argv) not in (3, 4):
        print(__doc__)
        return 2
    master = Master(sys.argv[3] if len(sys.argv) == 4 else "vcan0")
    drive = subprocess.Popen([sys.argv[1], sys.argv[3] if len(sys.argv) == 4 else "vcan0", sys.argv[2]],
                             stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    try:
        assert master.wait_for(0x701) == b"\x00"
        for check in (identity_and_transfers, heartbeat_and_nmt, mapping, motion, silence):
            check(master)
    finally:
        words, _ = drive.communicate(timeout=PATIENCE_S)
        print("drive_on_can:", words.strip())
    return drive.returncode


if __name__ == "__main__":
    sys.exit(main())
