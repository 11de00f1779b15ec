#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A MEMS accelerometer behind an iiod: the text protocol of libiio 0.2x, as far as its client asks for it.

Sample n of channel x is n, of y is -n, both big-endian, 20 of 32 bits, shifted by 12; the time stamp is n samples of
1 ms after 5 s. After block --skip-after the device loses --skip samples. Prints the port it listens on.
"""
import argparse
import socketserver
import struct
import time

HEADER = """<?xml version="1.0" encoding="utf-8"?><!DOCTYPE context [<!ELEMENT context (device | context-attribute)*>\
<!ELEMENT context-attribute EMPTY><!ELEMENT device (channel | attribute | debug-attribute | buffer-attribute)*>\
<!ELEMENT channel (scan-element?, attribute*)><!ELEMENT attribute EMPTY><!ELEMENT scan-element EMPTY>\
<!ELEMENT debug-attribute EMPTY><!ELEMENT buffer-attribute EMPTY>\
<!ATTLIST context name CDATA #REQUIRED description CDATA #IMPLIED>\
<!ATTLIST context-attribute name CDATA #REQUIRED value CDATA #REQUIRED>\
<!ATTLIST device id CDATA #REQUIRED name CDATA #IMPLIED>\
<!ATTLIST channel id CDATA #REQUIRED type (input|output) #REQUIRED name CDATA #IMPLIED>\
<!ATTLIST scan-element index CDATA #REQUIRED format CDATA #REQUIRED scale CDATA #IMPLIED>\
<!ATTLIST attribute name CDATA #REQUIRED filename CDATA #IMPLIED>\
<!ATTLIST debug-attribute name CDATA #REQUIRED><!ATTLIST buffer-attribute name CDATA #REQUIRED>]>"""
STAMP = ('<channel id="timestamp" type="input"><scan-element index="{}" format="le:s64/64&gt;&gt;0"/></channel>')


def describe(names, form, stamp, more=""):
    """The context of one device, adxl355, whose channels have samples of one form."""
    channels = "".join(f'<channel id="{name}" type="input"><scan-element index="{index}" format="{form}" scale="1"/>'
                       f'<attribute name="scale" filename="in_{name}_scale"/></channel>' for index, name in enumerate(names))
    return (HEADER + '<context name="local" description="emulated"><device id="iio:device0" name="adxl355">' + channels + more +
            (STAMP.format(len(names)) if stamp else "") + '<attribute name="sampling_frequency"/></device></context>')


class Client(socketserver.StreamRequestHandler):
    def say(self, text):
        self.wfile.write((str(text) + "\n").encode())

    def say_data(self, text):
        self.wfile.write(f"{len(text)}\n{text}\n".encode())

    def read_buffer(self, wanted):
        options = self.server.options
        count = wanted // len(self.server.sample(0))
        data = b"".join(self.server.sample(self.number + i) for i in range(count))
        self.number += count
        if options.in_real_time:
            self.due = max(self.due, time.monotonic() - 0.1) + count * 1e-3
            time.sleep(max(0.0, self.due - time.monotonic()))
        self.blocks += 1
        if self.blocks == options.skip_after:
            self.number += options.skip
        if self.blocks > options.blocks:
            self.say(-19)
            return
        self.say(len(data))
        self.say(f"{self.mask:08x}")
        self.wfile.write(bytes(data))

    def handle(self):
        self.number = self.blocks = self.mask = 0
        self.due = time.monotonic()
        for line in self.rfile:
            words = line.decode().split()
            if not words:
                continue
            if words[0] == "VERSION":
                self.say("0.24.0000000")
            elif words[0] == "PRINT":
                self.say_data(self.server.context())
            elif words[0] == "READ" and words[-1] in self.server.attributes:
                self.say_data(self.server.attributes[words[-1]] + "\0")
            elif words[0] == "OPEN":
                self.mask = int(words[3], 16)
                self.say(0)
            elif words[0] == "READBUF":
                self.read_buffer(int(words[2]))
            elif words[0] == "EXIT":
                return
            elif words[0] in ("TIMEOUT", "SET", "CLOSE"):
                self.say(0)
            else:
                self.say(-22)


class Server(socketserver.ThreadingTCPServer):
    daemon_threads = True
    allow_reuse_address = True
    attributes = {"scale": "0.000038245", "sampling_frequency": "1000.000000"}

    def context(self):
        temperature = '<channel id="temp" type="input"><attribute name="raw" filename="in_temp_raw"/></channel>'
        return describe(("accel_x", "accel_y"), "be:s20/32&gt;&gt;12", self.options.stamp, temperature)

    def sample(self, n):
        stamp = struct.pack("<q", 5_000_000_000 + n * 1_000_000) if self.options.stamp else b""
        return struct.pack(">ii", n << 12, -n << 12) + stamp


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--stamp", action="store_true", help="with a time-stamp channel")
    parser.add_argument("--blocks", type=int, default=20, help="blocks before the device is unplugged")
    parser.add_argument("--in-real-time", action="store_true", help="1000 samples a second; else as fast as asked")
    parser.add_argument("--skip-after", type=int, default=0)
    parser.add_argument("--skip", type=int, default=0)
    with Server(("127.0.0.1", 0), Client) as server:
        server.options = parser.parse_args()
        print(server.server_address[1], flush=True)
        server.serve_forever()


if __name__ == "__main__":
    main()
