#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# One frame out of the order of time, in the six log formats of python-can.
# Package: Debian python3-can 4.1.0-1.
# Input: four frames of two interfaces; the third is 3/4 s older than the first of the log, as happens where two interfaces,
#   each with a clock of its own, go into one log.
# Guess: every format keeps the four times, or all treat the late frame alike.
# What happens: six formats, three answers, no warning. CSV, SQLite and TRC keep the time. The log of candump and BLF give
#   the frame the time of the first one. ASC takes its time since 1970 for a time since the start of the log.
# Seen, in seconds after the first frame:
#   | written              0.000           0.500          -0.750           1.000
#   | read csv             0.000           0.500          -0.750           1.000
#   | read db              0.000           0.500          -0.750           1.000
#   | read trc             0.000           0.500          -0.750           1.000
#   | read log             0.000           0.500           0.000           1.000
#   | read blf             0.000           0.500           0.000           1.000
#   | read asc             0.000           0.500  1699999999.250           1.000
set -euo pipefail
source "$(dirname "$0")/packages.sh"
debian python3-can=4.1.0-1 python3-wrapt=1.14.1-2+b2 python3-msgpack=1.0.3-2+b1 python3-packaging=23.0-1 \
  python3-typing-extensions=4.4.0-1
python_modules can

cat >times.py <<'END'
import can

START = 1700000000.0
OFFSETS = [0.0, 0.5, -0.75, 1.0]
print("written    " + " ".join(f"{offset:15.3f}" for offset in OFFSETS))
for form in ("csv", "db", "trc", "log", "blf", "asc"):
    with can.Logger(f"frames.{form}") as log:
        for number, offset in enumerate(OFFSETS):
            log(can.Message(timestamp=START + offset, arbitration_id=0x181 + number % 2, is_extended_id=False,
                            data=[number], channel=number % 2))
    read = {message.data[0]: message.timestamp for message in can.LogReader(f"frames.{form}")}
    print(f"read {form:6}" + " ".join(f"{read[number] - read[0]:15.3f}" for number in range(len(OFFSETS))))
END
seen /usr/bin/python3 times.py
finish
