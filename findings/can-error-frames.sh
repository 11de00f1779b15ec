#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Error frames between candump's log files and python-can.
# Packages: Debian python3-can 4.1.0-1, can-utils 2020.11.0-1.
# Input: three error frames of SocketCAN, in the form of candump -L: bus-off (40), no acknowledgement (20), error passive of
#   the controller (04); and the same three as messages of python-can.
# Guess: python-can reads a log of candump frame by frame, and writes one that says the same.
# What happens: it looks for one bit of the class, 80 (bus error). A line without it it reads as an extended data frame with
#   the class for its id, no error frame. Whatever class it has to write, it writes 80: a bus-off is none any more.
#   log2asc of can-utils reads the same lines as error frames.
# Seen:
#   | a line of the log         (1.000000) can0 20000040#0000000000000000
#   | a line of the log         (2.000000) can0 20000020#0000000000000000
#   | a line of the log         (3.000000) can0 20000004#0010000000000000
#   | log2asc reads             ErrorFrame, ErrorFrame, ErrorFrame
#   | python-can reads          error frame: False, extended: True, id 40, 8 bytes
#   | python-can reads          error frame: False, extended: True, id 20, 8 bytes
#   | python-can reads          error frame: False, extended: True, id 4, 8 bytes
#   | python-can writes of 40   (1.000000) can0 20000080#0000000000000000
#   | python-can writes of 20   (2.000000) can0 20000080#0000000000000000
#   | python-can writes of 04   (3.000000) can0 20000080#0010000000000000
set -euo pipefail
source "$(dirname "$0")/packages.sh"
debian python3-can=4.1.0-1 python3-wrapt=1.14.1-2+b2 python3-msgpack=1.0.3-2+b1 python3-packaging=23.0-1 \
  python3-typing-extensions=4.4.0-1 can-utils=2020.11.0-1
python_modules can

cat >candump.log <<'END'
(1.000000) can0 20000040#0000000000000000
(2.000000) can0 20000020#0000000000000000
(3.000000) can0 20000004#0010000000000000
END
log2asc -I candump.log -O candump.asc can0
cat >both.py <<'END'
import can

for line in open("candump.log"):
    print(f"{'a line of the log':26}{line.strip()}")
frames = [line.split()[2] for line in open("candump.asc") if line.split()[1] == "1"]
print(f"{'log2asc reads':26}{', '.join(frames)}")
for message in can.LogReader("candump.log"):
    print(f"{'python-can reads':26}error frame: {message.is_error_frame}, extended: {message.is_extended_id}, "
          f"id {message.arbitration_id:X}, {len(message.data)} bytes")
classes = {0x40: bytes(8), 0x20: bytes(8), 0x04: bytes([0, 0x10, 0, 0, 0, 0, 0, 0])}
with can.Logger("python.log") as log:
    for time, (error_class, data) in enumerate(classes.items(), 1):
        log(can.Message(timestamp=float(time), arbitration_id=error_class, is_error_frame=True, dlc=8, data=data,
                        channel="can0"))
for error_class, line in zip(classes, open("python.log")):
    print(f"{f'python-can writes of {error_class:02X}':26}{line.strip()}")
END
seen /usr/bin/python3 both.py
finish
