#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Sends samples as TCP_STREAM.md has them: a model for a front end's own sender, and a device for tests.

Each channel is a ramp that counts samples, so that a receiver can check every one. Prints the port it listens on.
"""
import argparse
import json
import socket
import struct
import time
import zlib

HELLO, BLOCK, KEEP_ALIVE, END = 1, 2, 3, 4
KEEP_ALIVE_EVERY_S = 1.0


def message(kind, payload):
    head = struct.pack("<4sBBHI", b"SWS1", kind, 1, 0, len(payload))
    return head + struct.pack("<II", zlib.crc32(head), zlib.crc32(payload)) + payload


def hello(options):
    channels = [{"name": f"ch{i}_V", "unit": "V", "sensor_serial": f"S{i}"} for i in range(options.channels)]
    description = {"name": "reference_sender", "type": "int32", "rate_hz": options.rate, "counter_bits": 64,
                   "most_samples_a_block": options.samples, "channels": channels}
    return message(HELLO, json.dumps(description).encode())


def block(first, options):
    """Channel c of sample n is n + c, as the device counts n."""
    head = struct.pack("<QqII", first, int(first * 1e9 / options.rate), options.samples, 0)
    values = [(n + c) & 0x7FFFFFFF for n in range(first, first + options.samples) for c in range(options.channels)]
    return message(BLOCK, head + struct.pack(f"<{len(values)}i", *values))


class Stream:
    """The device: it counts on while nobody listens."""

    def __init__(self, options):
        self.options = options
        self.number = 0
        self.begin = time.monotonic()
        self.last_sent = 0.0

    def send(self, connection, data):
        connection.sendall(data)
        self.last_sent = time.monotonic()

    def wait_for(self, number, connection):
        if self.options.fast:
            return
        due = self.begin + number * self.options.samples / self.options.rate
        while (left := due - time.monotonic()) > 0:
            if time.monotonic() - self.last_sent >= KEEP_ALIVE_EVERY_S:
                now = struct.pack("<Qq", number * self.options.samples, int((time.monotonic() - self.begin) * 1e9))
                self.send(connection, message(KEEP_ALIVE, now))
            time.sleep(min(left, KEEP_ALIVE_EVERY_S / 4))

    def serve(self, connection):
        """True when the stream is over, False when the connection is to be made anew."""
        self.send(connection, hello(self.options))
        while self.number < self.options.blocks:
            number, self.number = self.number, self.number + 1
            self.wait_for(number + 1, connection)
            if number in self.options.drop:
                continue
            data = bytearray(block(number * self.options.samples, self.options))
            if number in self.options.corrupt:
                data[len(data) // 2] ^= 0x10
            if number in self.options.garbage:
                data = b"SWSnoise" * 5 + data
            self.send(connection, bytes(data))
            if number in self.options.disconnect:
                return False
        self.send(connection, message(END, b""))
        return True


def numbers(text):
    return {int(number) for number in text.split(",") if number}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=0, help="0 takes a free one")
    parser.add_argument("--rate", type=float, default=51200.0, help="samples a second and channel")
    parser.add_argument("--channels", type=int, default=4)
    parser.add_argument("--samples", type=int, default=512, help="a block")
    parser.add_argument("--blocks", type=int, default=1 << 62)
    parser.add_argument("--fast", action="store_true", help="as fast as the receiver takes them")
    for fault in ("drop", "corrupt", "garbage", "disconnect"):
        parser.add_argument(f"--{fault}", type=numbers, default=set(), metavar="N,N...", help=f"blocks to {fault} at")
    options = parser.parse_args()
    stream = Stream(options)
    with socket.create_server((options.host, options.port)) as server:
        print(server.getsockname()[1], flush=True)
        while True:
            connection, _ = server.accept()
            with connection:
                try:
                    if stream.serve(connection):
                        return
                except ConnectionError:
                    pass


if __name__ == "__main__":
    main()
