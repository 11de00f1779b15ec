#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A campaign's own records, recomputed and diagnosed alone, take what the campaign beside them knows.

usage: campaign_records_test.py PROGRAM"""
import json
import pathlib
import re
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import unittest

PROGRAM, FOLDER = "", pathlib.Path()
SMALL = pathlib.Path(__file__).resolve().parent / "small.yaml"
NO_BLANK = "holds the bench's compliance: no blank test"


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def report(*arguments):
    _, out, error = run(*arguments, "--json")
    assert out, error
    return json.loads(out)


def campaign(name, change):
    """One short cycle, with some of small.yaml changed."""
    schedule = FOLDER / f"{name}.yaml"
    text = SMALL.read_text().replace("cycles: 3", "cycles: 1").replace("duration: 20 min", "duration: 1 min")
    schedule.write_text(change(text))
    code, out, error = run("run", schedule, "--out", FOLDER / name)
    assert code == 0, error
    return FOLDER / name, out


def without_blank(text):
    start, end = text.index("  - kind: blank_test"), text.index("phases:")
    return text[:start].replace("preparation:\n", "") + text[end:]


def of_kind(reports, kind):
    return [one for one in reports if one["kind"] == kind]


class WithABlankTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder, _ = campaign("blank", lambda text: text)
        cls.file = cls.folder / "cycles/000001.h5"
        cls.cycle = report("recompute", cls.folder)["cycles"][0]
        cls.alone = report("recompute", cls.file)

    def test_stiffness_is_that_of_the_campaign(self):
        loops = of_kind(self.alone, "hysteresis")
        for k in ("k1", "k2", "k3"):
            mean = sum(loop[f"{k}_Nm_per_rad"] for loop in loops) / len(loops)
            self.assertAlmostEqual(mean, self.cycle[f"{k}_Nm_per_rad"], delta=1e-6)

    def test_transmission_error_and_its_error_are_those_of_the_campaign(self):
        sweep, = of_kind(self.alone, "transmission_error")
        for key in ("e_avg_arcmin", "e_avg_arcmin_se", "e_max_arcmin", "e_max_arcmin_se", "lost_motion_arcmin"):
            self.assertEqual(sweep[key], self.cycle[key], key)

    def test_says_what_was_taken(self):
        self.assertEqual(sorted({one["kind"] for one in self.alone}), ["hysteresis", "transmission_error"])
        for one in self.alone:
            self.assertEqual(one["campaign"], str(self.folder))
            self.assertEqual(one["warnings"], [])
            self.assertTrue(any(note.startswith(f"taken off, as the campaign in {self.folder} does: ")
                                for note in one["notes"]), one["notes"])

    def test_the_diagnosis_starts_from_the_same_numbers(self):
        diagnosed = report("diagnose", self.file, "--kind", "transmission_error")
        self.assertAlmostEqual(diagnosed["quantities"]["e_avg_arcmin"]["measured"], self.cycle["e_avg_arcmin"], 9)
        self.assertTrue(any(note.startswith("taken off") for note in diagnosed["notes"]), diagnosed["notes"])

    def test_the_pictures_errors_are_the_tables(self):
        code, _, error = run("recompute", self.file, "--plots", FOLDER / "pictures")
        self.assertEqual(code, 0, error)
        svg = next((FOLDER / "pictures").glob("*transmission_error*.svg")).read_text()
        shown = re.search(r"cw: e_max = ([0-9.]+) ± ([0-9.]+)", svg)
        self.assertIsNotNone(shown)
        self.assertAlmostEqual(float(shown[1]), self.cycle["e_max_arcmin"], delta=1e-3)
        self.assertAlmostEqual(float(shown[2]) / self.cycle["e_max_arcmin_se"], 1.0, delta=0.05)

    def test_a_copy_elsewhere_says_what_it_lacks(self):
        copy = shutil.copy(self.file, FOLDER / "copy.h5")
        loop = of_kind(report("recompute", copy), "hysteresis")[0]
        self.assertIn("group '/hysteresis/hysteresis_1': the campaign that this loop was measured in is not beside it: K "
                      "holds the bench's compliance, which its blank test knows", loop["warnings"])
        self.assertLess(loop["k1_Nm_per_rad"], 0.8 * self.cycle["k1_Nm_per_rad"])

    def test_another_file_in_its_place_is_told(self):
        folder = shutil.copytree(self.folder, FOLDER / "exchanged")
        shutil.copy(folder / "cycles/000000.h5", folder / "cycles/000001.h5")
        _, out, error = run("recompute", folder / "cycles/000001.h5", "--json")
        for one in json.loads(out):
            self.assertTrue(any("is not the file that the campaign" in warning for warning in one["warnings"]))
        self.assertIn(f"{folder}/cycles/000001.h5: warning: group '/", error)

    def test_the_blank_itself_is_not_corrected(self):
        _, out, _ = run("recompute", self.folder / "cycles/000000.h5", "--json")
        blanks = [one for one in json.loads(out) if any("a blank test: " in text for text in one["warnings"])]
        self.assertEqual(len(blanks), 2)


class WithoutABlankTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder, cls.table = campaign("none", without_blank)

    def test_the_table_says_so(self):
        self.assertIn(NO_BLANK, self.table)

    def test_the_journal_says_so(self):
        with sqlite3.connect(f"file:{self.folder}/campaign.db?mode=ro", uri=True) as journal:
            flags = dict(journal.execute("SELECT quantity, flag FROM results WHERE quantity LIKE 'k__Nm_per_rad'"))
        self.assertEqual(flags, {f"k{k}_Nm_per_rad": NO_BLANK for k in (1, 2, 3)})

    def test_the_json_says_so(self):
        self.assertEqual(report("recompute", self.folder)["cycles"][0]["flags"]["k1_Nm_per_rad"], NO_BLANK)

    def test_a_record_alone_says_so(self):
        loop = of_kind(report("recompute", self.folder / "cycles/000001.h5"), "hysteresis")[0]
        self.assertIn(f"group '/hysteresis/hysteresis_1': K {NO_BLANK} (the campaign in {self.folder})",
                      loop["warnings"])


if __name__ == "__main__":
    PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    with tempfile.TemporaryDirectory() as scratch:
        FOLDER = pathlib.Path(scratch).resolve()
        sys.exit(not unittest.main(exit=False).result.wasSuccessful())
