#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Records with values that no quantity can have, and files that claim too much: words and exit code 2, whatever the
command, and never a crash.

usage: hostile_records_test.py PROGRAM [--seed N]"""
import argparse
import math
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import unittest

PROGRAM, SEED, FOLDER = "", 1, pathlib.Path()
HUGE = ["1e155", "1e200", "-1.5e308", "1e32", "-4e31"]
TINY = ["5e-324", "-1e-310", "1e-200"]


def run(command, *arguments):
    done = subprocess.run([PROGRAM, command, *map(str, arguments)], capture_output=True, text=True, check=False, timeout=100)
    return done.returncode, done.stdout, done.stderr


def triangle(n, most):
    return [most * (4 * abs((i / n + 0.25) % 1 - 0.5) - 1) for i in range(n)]


class Record:
    """A good one, as lines."""

    def __init__(self, kind, metadata, columns):
        self.kind, self.metadata, self.columns = kind, dict(metadata), {name: list(map(repr, values)) for name, values in
                                                                        columns.items()}

    def write(self, name):
        lines = [f"# kind: {self.kind}"] + [f"# {key}: {value}" for key, value in self.metadata.items()]
        lines.append(",".join(self.columns))
        lines += [",".join(cell.strip("'") for cell in row) for row in zip(*self.columns.values(), strict=True)]
        path = FOLDER / name
        path.write_text("\n".join(lines) + "\n")
        return path

    def line(self, row):
        return len(self.metadata) + 3 + row


def good_records():
    rng = random.Random(SEED)
    noise = lambda n, size: [rng.gauss(0, size) for _ in range(n)]  # noqa: E731
    n = 240
    torque = [t + e for t, e in zip(triangle(n, 34.0), noise(n, 0.02))]
    loop = {"time_s": [0.1 * i for i in range(n)], "torque_Nm": torque,
            "output_angle_deg": [math.degrees(t / 2e4) for t in torque], "temperature_degC": [25.0 + 1e-3 * i for i in range(n)]}
    output = [1.0 * i for i in range(361)]
    sweep = {"direction": ["cw"] * 361, "input_angle_deg": [80.0 * a for a in output],
             "output_angle_deg": [a + 0.01 * math.sin(2 * 80 * math.radians(a)) + e for a, e in
                                  zip(output, noise(361, 1e-3))], "time_s": [0.1 * i for i in range(361)]}
    n = 400
    speed = [2 * math.sin(0.05 * i) for i in range(n)]
    motion = {"time_s": [0.01 * i for i in range(n)], "position_rad": [-0.4 * math.cos(0.05 * i) for i in range(n)],
              "torque_Nm": [0.3 * v + math.copysign(0.5, v) + e for v, e in zip(speed, noise(n, 0.01))]}
    vibration = {"accel_x_m_per_s2": noise(2048, 1.0), "mic_Pa": noise(2048, 0.1)}
    return [Record("hysteresis", {"t1_Nm": 7.0, "t2_Nm": 25.0, "t3_Nm": 34.0}, loop),
            Record("transmission_error", {"ratio": 80}, sweep),
            Record("motion", {"inertia_kgm2": 0.1}, motion),
            Record("vibration", {"sample_rate_hz": 12800, "input_speed_rpm": 2400}, vibration)]


COMMANDS = {"hysteresis": ["recompute", "diagnose"], "transmission_error": ["recompute", "diagnose"],
            "motion": ["diagnose"], "vibration": ["features", "diagnose"]}


class HostileRecords(unittest.TestCase):
    def setUp(self):
        self.rng = random.Random(SEED)

    def refuses(self, command, path, pattern):
        code, _, error = run(command, path)
        self.assertEqual(code, 2, f"{command} {path}: {error}")
        self.assertRegex(error, pattern)

    def test_no_quantity_is_huge(self):
        for record in good_records():
            for name, values in record.columns.items():
                if name == "direction":
                    continue
                row, huge, before = self.rng.randrange(len(values)), self.rng.choice(HUGE), list(values)
                values[row] = huge
                path = record.write(f"{record.kind}-{name}.csv")
                # A time that goes up by so much is found where it comes; the rows after it go back.
                for command in COMMANDS[record.kind]:
                    self.refuses(command, path, rf"(?m)^{re.escape(str(path))}:{record.line(row)}:\d+: error: {name} "
                                 r"(is \S+ \(expected a number from|runs backwards)")
                record.columns[name] = before

    def test_no_metadata_is_huge_or_as_good_as_zero(self):
        for record in good_records():
            for place, key in enumerate(list(record.metadata)):
                before = record.metadata[key]
                for value in ("1e300", "1e-300", "-1e200"):
                    if key == "input_speed_rpm" and value == "1e-300":
                        continue
                    record.metadata[key] = value
                    path = record.write(f"{record.kind}-{key}.csv")
                    self.refuses(COMMANDS[record.kind][0], path, rf"(?m)^{re.escape(str(path))}:{place + 2}:\d+: error: {key} ")
                record.metadata[key] = before

    def test_values_as_good_as_zero_end_in_words(self):
        for record in good_records():
            for name, values in record.columns.items():
                if name in ("direction", "time_s"):
                    continue
                before = list(values)
                for tiny in self.rng.sample(TINY, 2):
                    values[:] = [self.rng.choice([tiny, "0"]) for _ in values]
                    path = record.write(f"tiny-{record.kind}-{name}.csv")
                    for command in COMMANDS[record.kind]:
                        code, _, error = run(command, path)
                        self.assertIn(code, (0, 1, 2), f"{command} {path}: {error}")  # 1: a failed check
                values[:] = before

    def test_a_file_that_claims_too_much_is_refused_at_once(self):
        path = FOLDER / "wide.csv"
        names = ",".join(f"c{i}_V" for i in range(100_000))
        path.write_text(f"# kind: vibration\n# sample_rate_hz: 1\n{names}\n1\n")
        self.refuses("features", path, r"wide\.csv:3:\d+: error: the header has 100000 columns \(expected at most 10000: ")
        path = FOLDER / "talkative.csv"
        path.write_text("# kind: vibration\n" + "".join(f"# k{i}: {i}\n" for i in range(100_000)) + "x_V\n1\n")
        self.refuses("features", path, r"talkative\.csv:10001:1: error: there are more than 10000 lines of metadata ")
        path = FOLDER / "long.csv"
        path.write_text("# kind: vibration\n# sample_rate_hz: 1\nx_V\n1\n" + "1" * 3_000_000 + "\n")
        self.refuses("features", path, r"long\.csv:5:1048577: error: the line has 3000000 bytes ")
        path = FOLDER / "endless.csv"
        with path.open("wb") as file:
            file.truncate(1 << 40)  # takes no room on the disk
        self.refuses("features", path, r"endless\.csv: error: the file has more than 2147483647 bytes ")


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    PROGRAM, SEED = str(pathlib.Path(options.program).resolve()), options.seed
    with tempfile.TemporaryDirectory() as folder:
        FOLDER = pathlib.Path(folder)
        sys.exit(not unittest.main(argv=sys.argv[:1], exit=False).result.wasSuccessful())
