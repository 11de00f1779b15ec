#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave diagnose --power` on a sweep made here: text, JSON, files; the same numbers again; what is refused.

usage: diagnose_power_command_test.py PROGRAM"""
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

PROGRAM, FOLDER = "", pathlib.Path()
RATIO, STEP_DEG, NOISE_ARCMIN = 80, 3, 0.05


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def write_sweep(path, kind="transmission_error"):
    """One turn clockwise with a second harmonic and white noise: no backlash, torque or temperature in it."""
    draw = random.Random(5)
    lines = ["# kind: " + kind, "# ratio: %d" % RATIO, "time_s,input_angle_deg,output_angle_deg,direction"]
    for i in range(360 // STEP_DEG + 1):
        output_deg = STEP_DEG * i + 0.3 * draw.random()
        error_deg = (0.4 * math.cos(2 * math.radians(RATIO * output_deg)) + draw.gauss(0, NOISE_ARCMIN)) / 60
        lines.append("%.3f,%.6f,%.6f,cw" % (2 * i, RATIO * output_deg, output_deg - error_deg))
    path.write_text("\n".join(lines) + "\n")
    return path


class DiagnosePower(unittest.TestCase):
    def test_text_json_and_files(self):
        sweep = write_sweep(FOLDER / "sweep.csv")
        code, out, err = run("diagnose", sweep, "--power", "--json", "--out", FOLDER / "out")
        self.assertEqual(code, 0, err)
        power = json.loads(out)["power"]
        self.assertEqual(json.loads((FOLDER / "out/diagnosis.json").read_text())["power"], power)
        for ending in (".svg", ".png"):
            self.assertGreater((FOLDER / "out" / ("detection_power" + ending)).stat().st_size, 1000)
        causes = {cause["name"]: cause for cause in power["causes"]}
        eccentricity = causes["output_eccentricity"]
        self.assertEqual(eccentricity["unit"], "arcmin")
        # In about 6 standard errors, each noise * sqrt(2 / samples).
        size = eccentricity["size"]["value"]
        self.assertGreater(size, 3 * NOISE_ARCMIN * math.sqrt(2 / 121))
        self.assertLess(size, 15 * NOISE_ARCMIN * math.sqrt(2 / 121))
        self.assertIn("backlash", power["not_shown"])
        self.assertIn("load_windup", power["not_shown"])
        self.assertEqual(power["without_effect"]["records"], 20)
        code, out, err = run("diagnose", sweep, "--power")
        self.assertEqual(code, 0, err)
        self.assertIn("\npower        what would have been found here nine times of ten (", out)
        self.assertIn("             - an error once per turn of the output: ", out)
        self.assertIn("%.3g" % size, out)  # the same seed, the same sizes

    def test_no_power_without_the_option(self):
        code, out, _ = run("diagnose", write_sweep(FOLDER / "plain.csv"), "--json")
        self.assertEqual(code, 0)
        self.assertNotIn("power", json.loads(out))

    def test_refuses_what_cannot_be_measured(self):
        sweep = write_sweep(FOLDER / "both.csv")
        code, out, err = run("diagnose", sweep, "--power", "--judge-by-simulation")
        self.assertEqual((code, out), (2, ""))
        self.assertEqual(err, "%s: error: --power beside --judge-by-simulation (expected one of the two)\n" % sweep)
        other = write_sweep(FOLDER / "other.csv", "motor")
        code, out, err = run("diagnose", other, "--power")
        self.assertEqual((code, out), (2, ""))
        self.assertIn("error: ", err)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    with tempfile.TemporaryDirectory() as folder:
        FOLDER = pathlib.Path(folder)
        unittest.main()
