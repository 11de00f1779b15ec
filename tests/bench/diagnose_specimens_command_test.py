#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave diagnose --by-specimen` on sweeps made here: verdicts, text, files, who is taken for whom; what is refused.

usage: diagnose_specimens_command_test.py PROGRAM"""
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

PROGRAM, FOLDER = "", pathlib.Path()
RATIO, STEP_DEG, NOISE_ARCMIN = 80, 3, 0.03
TURN = 360 // STEP_DEG


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def write_sweep(name, seed, specimen=None, amplitude=0.0, phase_deg=0.0, kind="transmission_error"):
    """One turn each way with a second harmonic, an error once per output turn, and white noise."""
    draw = random.Random(seed)
    lines = ["# kind: " + kind, "# ratio: %d" % RATIO]
    lines += ["# specimen: " + specimen] if specimen else []
    lines += ["time_s,input_angle_deg,output_angle_deg,direction"]
    for i in range(2 * (TURN + 1)):
        output_deg = STEP_DEG * min(i, 2 * TURN + 1 - i) + 0.3 * draw.random()
        error = 0.4 * math.cos(2 * math.radians(RATIO * output_deg)) + draw.gauss(0, NOISE_ARCMIN)
        error += amplitude * math.cos(math.radians(output_deg - phase_deg))
        lines.append("%.3f,%.6f,%.6f,%s" % (2 * i, RATIO * output_deg, output_deg - error / 60, "cw" if i <= TURN else "ccw"))
    path = FOLDER / name
    path.parent.mkdir(exist_ok=True)
    path.write_text("\n".join(lines) + "\n")
    return path


def sweeps(folder, effects):
    return [write_sweep("%s/%d.csv" % (folder, k), 10 + k, "HD %d" % k, *effect) for k, effect in enumerate(effects)]


class DiagnoseSpecimens(unittest.TestCase):
    def refused(self, message, *arguments):
        code, out, err = run("diagnose", *arguments, "--by-specimen", "--out", FOLDER / "refused")
        self.assertEqual((code, out), (2, ""))
        self.assertEqual(err, message)
        self.assertFalse((FOLDER / "refused").exists())

    def test_an_effect_of_the_bench_is_shared(self):
        files = sweeps("bench", 4 * [(0.3, 40)])
        out = FOLDER / "bench/out"
        code, text, err = run("diagnose", *files, "--by-specimen", "--json", "--out", out)
        self.assertEqual((code, err), (0, ""))
        document = json.loads(text)
        self.assertEqual(json.loads((out / "specimens.json").read_text()), document)
        self.assertEqual([one["specimen"] for one in document["specimens"]], ["HD 0", "HD 1", "HD 2", "HD 3"])
        [cause] = document["shared"]
        self.assertEqual((cause["name"], cause["verdict"]), ("output_eccentricity", "shared"))
        self.assertEqual((cause["parameter"], cause["unit"]), ("amplitude_arcmin", "arcmin"))
        self.assertTrue(cause["with_phase"])
        self.assertTrue(cause["sentence"].startswith("comes with the bench: all 4 specimens have it"), cause["sentence"])
        # Noise * sqrt(2 / samples) a specimen, half of it the mean; four of it.
        self.assertAlmostEqual(cause["mean"]["value"], 0.3, delta=4 * NOISE_ARCMIN * math.sqrt(2 / 242) / 2)
        self.assertLess(cause["between"]["high"], 0.05)
        self.assertEqual(cause["homogeneity"]["degrees_of_freedom"], 6)
        self.assertIsNone(cause["specimens_needed"])
        # Each specimen's own diagnosis is what it is without the others, and so are its files.
        for one, file in zip(document["specimens"], files):
            folder = out / one["folder"]
            self.assertEqual(one["folder"], one["specimen"].replace(" ", "_"))
            alone = json.loads(run("diagnose", file, "--json")[1])
            self.assertEqual(one["diagnosis"], alone)
            self.assertEqual(alone["causes"][0]["where"], "undecided")
            self.assertEqual(json.loads((folder / "diagnosis.json").read_text()), alone)
            self.assertIn("cause: \"output_eccentricity\"", (folder / "extended_model.yaml").read_text())
            self.assertTrue((folder / "candidates.svg").exists())
        for ending in (".svg", ".png"):
            self.assertGreater((out / ("specimens" + ending)).stat().st_size, 3000)
        self.assertIn("HD 2", (out / "specimens.svg").read_text())
        # What is known leaves nothing to compare.
        model = out / "HD_0/extended_model.yaml"
        code, text, err = run("diagnose", *files, "--by-specimen", "--json", "--model", model)
        self.assertEqual((code, json.loads(text)["shared"]), (0, []), err)

    def test_text(self):
        files = sweeps("text", [(0.3, 40), (0.15, 170), (0.4, 250)])
        code, text, err = run("diagnose", *files, "--by-specimen")
        self.assertEqual((code, err), (0, ""))
        self.assertTrue(text.startswith("3 specimens, records of kind transmission_error: 0 shared (with the bench), "
                                        "1 own (to the units), 0 undecided.\n\nHD 0         One effect is missing in"),
                        text)
        self.assertIn("\noutput_eccentricity: own (amplitude_arcmin)\n", text)
        self.assertRegex(text, r"\n             HD 1 +0\.1[45]\d* ± 0\.00\d+ arcmin +at 1\d\d\.\d ± \d\.\d deg +found\n")
        self.assertRegex(text, r"\n             between specimens +0\.\d+ arcmin +\(95 %: [\d.]+ to [\d.]+\) +all alike: p ")
        self.assertIn("like the units' own", text)
        code, text, _ = run("diagnose", *files, "--by-specimen", "--details", "--out", FOLDER / "text/out")
        self.assertEqual(code, 0)
        self.assertIn("\n== HD 1 ==\nWhat the simulation lacks:", text)
        self.assertIn("\ntogether     %s\n" % (FOLDER / "text/out/specimens.json"), text)

    def test_nothing_in_any(self):
        code, text, err = run("diagnose", *sweeps("none", 3 * [()]), "--by-specimen", "--out", FOLDER / "none/out")
        self.assertEqual((code, err), (0, ""))
        self.assertTrue(text.startswith("3 specimens, records of kind transmission_error: no cause was found in any of "
                                        "them.\n"), text)
        self.assertFalse((FOLDER / "none/out/specimens.svg").exists())

    def test_records_of_one_specimen_are_fitted_together(self):
        files = [write_sweep("both/a.csv", 1, "A"), write_sweep("both/b.csv", 2, "B"), write_sweep("both/a2.csv", 3, "A")]
        code, text, err = run("diagnose", *files, "--by-specimen", "--json")
        self.assertEqual((code, err), (0, ""))
        records = [[record["file"] for record in one["diagnosis"]["records"]] for one in json.loads(text)["specimens"]]
        self.assertEqual(records, [[str(files[0]), str(files[2])], [str(files[1])]])

    def test_a_file_without_a_name_is_a_specimen_of_its_own(self):
        files = [write_sweep("own/first.csv", 1), write_sweep("own/second.csv", 2, "first")]
        code, text, err = run("diagnose", *files, "--by-specimen", "--json")
        self.assertEqual(code, 0)
        self.assertEqual(err, "%s: warning: names no specimen (metadata 'specimen'): taken for one of its own, %s\n" %
                         (files[0], files[0]))
        specimens = json.loads(text)["specimens"]
        self.assertEqual([one["specimen"] for one in specimens], [str(files[0]), "first"])
        self.assertIn("names no specimen (metadata 'specimen'): taken for one of its own, %s" % files[0],
                      specimens[0]["diagnosis"]["warnings"])

    def test_power_is_measured_in_each(self):
        code, text, err = run("diagnose", *sweeps("power", 2 * [()]), "--by-specimen", "--power", "--json")
        self.assertEqual(code, 0, err)
        for one in json.loads(text)["specimens"]:
            self.assertEqual(one["diagnosis"]["power"]["without_effect"]["records"], 20)

    def test_refusals(self):
        one = write_sweep("no/one.csv", 1, "A")
        again = write_sweep("no/again.csv", 2, "A")
        self.refused("%s: error: one specimen alone, A (expected records of two or more, told apart by the metadata "
                     "'specimen'; for one leave out --by-specimen)\n" % one, one, again)
        loop = FOLDER / "no/axis.csv"
        loop.write_text("# kind: motion\n# specimen: B\ntime_s,position_rad,torque_Nm\n" +
                        "".join("%g,%g,%g\n" % (0.01 * i, math.sin(0.1 * i), math.cos(0.1 * i)) for i in range(400)))
        self.refused("%s: error: the records are of 2 kinds: motion, transmission_error (expected one kind; --kind "
                     "chooses it)\n" % one, one, loop)
        nothing = FOLDER / "no/notes.csv"
        nothing.write_text("these are no numbers\n")
        code, out, err = run("diagnose", one, nothing, "--by-specimen")
        self.assertEqual((code, out), (2, ""))
        self.assertTrue(err.startswith("%s:1" % nothing), err)
        self.refused("%s: error: a folder beside --by-specimen (expected the record files of two or more specimens)\n" %
                     FOLDER, FOLDER, one)
        copy = FOLDER / "no/copy.csv"
        text = write_sweep("no/unnamed.csv", 3).read_text()
        copy.write_text(text)
        self.refused("%s: error: holds the same record as %s before it (expected each record once)\n" %
                     (copy, FOLDER / "no/unnamed.csv"), FOLDER / "no/unnamed.csv", copy)
        other = write_sweep("no/other.csv", 4, "B")
        self.refused("%s: error: --power beside --judge-by-simulation (expected one of the two)\n" % one, one, other,
                     "--power", "--judge-by-simulation")
        self.refused("%s: error: a record of kind transmission_error is not judged by simulation (expected one of kind "
                     "motion, or no --judge-by-simulation)\n" % one, one, other, "--judge-by-simulation")


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    with tempfile.TemporaryDirectory() as folder:
        FOLDER = pathlib.Path(folder)
        unittest.main()
