#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Sheets of trip tests, diagnoses and predictors in a report: found in the campaign's folder, or given; each with what its own
command wrote; and what is said of a file that is something else, whole.

usage: report_papers_test.py PROGRAM SCHEDULE"""
import csv
import hashlib
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from report_command_test import Page  # noqa: E402

PROGRAM, SCHEDULE = "", ""
TRIP = "the sheet that strainwave bench trip-test --out writes"
DIAGNOSIS = "diagnosis.json, as strainwave diagnose --out or --json writes it"
PREDICTOR = "a folder of strainwave train --out, with predictor.json, or of strainwave export, with recipe.json"
POWER = {"probability": 0.9, "records_searched": 42, "not_shown": ["creep"],
         "without_effect": {"records": 20, "with_other_names": 1, "other_names": {"backlash": 1}},
         "causes": [{"name": "backlash", "parameter": "gap", "unit": "arcmin", "size": {"value": 0.24, "low": 0.2, "high": 0.3},
                     "sigma": {"value": 5.1, "low": 4.0, "high": None}, "objection": "", "found": 7, "with_other_names": 1,
                     "other_names": {"creep": 2}, "trials": [{}] * 9},
                    {"name": "creep", "parameter": "share", "unit": "", "size": None, "sigma": None, "objection": "too slow", "found": 0,
                     "with_other_names": 0, "other_names": {}, "trials": [{}] * 4}]}
CARD = {"exported_utc": "2026-03-01T12:00:00.250Z", "predicts": "values", "outputs": ["k2_Nm_per_rad"],
        "operating_envelope": {"output_torque_Nm": [39.5, 40.25], "temperature_degC": None},
        "training": {"records": 30, "design": "wide", "data_sha256": "ab" * 32,
                     "campaigns": [{"folder": "<campaign>", "specimen": "SIM-0001", "records": 30}],
                     "splits": [{"split": "specimen", "meaning": "reducers never seen", "train": 20, "test": 10,
                                 "scores": {"network": {"k2_Nm_per_rad": {"mape_percent": 1.25}}}}]}}


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def export(folder, card):
    """A folder as `export` leaves it, as far as a report reads it."""
    folder.mkdir()
    text = json.dumps(card)
    (folder / "model_card.json").write_text(text)
    recipe = {"model_card_json": {"file": "model_card.json", "sha256": hashlib.sha256(text.encode()).hexdigest()}}
    recipe["sha256"] = hashlib.sha256(json.dumps(recipe, separators=(",", ":")).encode()).hexdigest()
    (folder / "recipe.json").write_text(json.dumps(recipe))


class Papers(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.folder = pathlib.Path(cls.scratch.name)
        text = pathlib.Path(SCHEDULE).read_text().replace("cycles: 12", "cycles: 2").replace("duration: 1 min", "duration: 5 s")
        text = text.replace("steps: 360", "steps: 72").replace("step: 1 deg", "step: 5 deg").replace("repeatability_repeats: 5", "repeatability_repeats: 2")
        (cls.folder / "schedule.yaml").write_text(text)
        cls.campaign = cls.folder / "c"
        code, _, told = run("run", cls.folder / "schedule.yaml", "--out", cls.campaign)
        assert code == 0, told
        code, _, told = run("bench", "trip-test", "--schedule", SCHEDULE, "--only", "drive_fault", "--out", cls.folder / "trips.json")
        assert code == 0, told
        cls.sheet = json.loads((cls.folder / "trips.json").read_text())
        code, _, told = run("diagnose", cls.campaign / "cycles/000001.h5", "--kind", "hysteresis", "--out", cls.folder / "d")
        assert code == 0, told
        cls.diagnosis = json.loads((cls.folder / "d/diagnosis.json").read_text())
        export(cls.folder / "exported", CARD)

    def report(self, *papers, name="r"):
        code, said, told = run("report", self.campaign, "--out", self.folder / f"{name}.html", "--csv", self.folder / name, *papers)
        self.assertEqual(code, 0, told)
        return Page((self.folder / f"{name}.html").read_text())

    def refused(self, *papers):
        """What is said; nothing is written."""
        page, tables = self.folder / "no.html", self.folder / "no"
        code, said, told = run("report", self.campaign, "--out", page, "--csv", tables, *papers)
        self.assertEqual((code, said), (2, ""), told)
        self.assertFalse(page.exists() or tables.exists())
        return told

    def test_that_there_is_none_is_said(self):
        page = self.report()
        for words in ("No sheet of a trip test lies in the folder, and none was given.",
                      "No diagnosis lies in the folder, and none was given.", "No predictor lies in the folder, and none was given."):
            self.assertIn(words, page.words)

    def test_trip_tests_have_a_row_each(self):
        page = self.report("--trip-test", self.folder / "trips.json")
        rows = page.table("verdict", "signal")
        self.assertEqual([row[:2] for row in rows], [[row["verdict"], row["signal"]] for row in self.sheet["rows"]])
        self.assertEqual([row[4] for row in rows], ["%.0f" % (1e3 * row["tripped_after_s"]) for row in self.sheet["rows"]])
        self.assertTrue(any("2 passed, 0 failed, 0 skipped" in words for words in page.words))
        with (self.folder / "r/trip_test.csv").open(newline="") as file:
            self.assertEqual(list(csv.reader(file))[1:], rows)

    def test_what_lies_in_the_campaign_is_found_once(self):
        (self.campaign / "trip_test.json").write_text(json.dumps(self.sheet))
        try:
            page = self.report("--trip-test", self.campaign / "../c/trip_test.json")
            self.assertEqual([head for head in page.headings if head.startswith("Fault")], ["Fault and trip tests"])
            page = self.report("--trip-test", self.folder / "trips.json", name="two")
            self.assertEqual([head for head in page.headings if head.startswith("Fault")], ["Fault and trip tests", "Fault and trip tests 2"])
            self.assertTrue((self.folder / "two/trip_test_2.csv").exists())
        finally:
            (self.campaign / "trip_test.json").unlink()

    def test_a_diagnosis_has_its_causes(self):
        page = self.report("--diagnosis", self.folder / "d/diagnosis.json")
        self.assertTrue(any(words.startswith(f"Verdict: {self.diagnosis['verdict']}. Kind: hysteresis.") for words in page.words))
        if self.diagnosis["causes"]:
            rows = page.table("cause", "where")
            self.assertEqual([row[0] for row in rows], [cause["name"] for cause in self.diagnosis["causes"]])
        else:
            self.assertIn("No cause is named.", page.words)
        self.assertIn("How large an effect has to be to be found was not measured (strainwave diagnose --power).", page.words)
        self.assertTrue(any("How sure: " in words and "What to do: " in words for words in page.words))

    def test_a_diagnosis_says_what_to_measure(self):
        settle = ["# the same sweep twice,\n# in half the step\n- kind: hysteresis\n  loops: 2\n"]
        (self.folder / "settle.json").write_text(json.dumps(self.diagnosis | {"to_settle": settle}))
        page = self.report("--diagnosis", self.folder / "settle.json")
        self.assertIn("To settle what is open: the same sweep twice, in half the step. As phases of a schedule: - kind: hysteresis   loops: 2", page.words)

    def test_a_diagnosis_has_its_trusted_regions(self):
        def at(low, high, rmse, nominal, extended):
            return {"low": low, "high": high, "samples": 100, "nominal": {"rmse": rmse, "result": nominal}, "extended": {"rmse": 0.02, "result": extended}}
        ranges = [at(0, 10, 0.02, "holds", "holds"), at(10, 20, 0.3, "fails", "holds"), at(20, 30, 0.4, "fails", "holds"), at(40, 50, 0.1, "fails", "too_few_samples")]
        regions = {"noise": 0.02, "unit": "arcmin", "tolerated_excess": 1.3, "over": [{"regressor": "torque", "title": "torque / Nm", "ranges": ranges}]}
        (self.folder / "regions.json").write_text(json.dumps(self.diagnosis | {"trusted_regions": regions}))
        page = self.report("--diagnosis", self.folder / "regions.json")
        self.assertEqual(page.table("over", "from"), [
            ["torque / Nm", "0", "10", "0.02", "holds", "0.02", "holds"],
            ["torque / Nm", "10", "30", "0.4", "fails", "0.02", "holds"],
            ["torque / Nm", "40", "50", "0.1", "fails", "0.02", "too few samples"]])
        older = {key: value for key, value in self.diagnosis.items() if key not in ("trusted_regions", "plain_words")}
        (self.folder / "older.json").write_text(json.dumps(older))
        page = self.report("--diagnosis", self.folder / "older.json")
        self.assertIn("Where the simulation may be trusted is not in this file: an older program wrote it.", page.words)

    def test_a_diagnosis_has_its_power(self):
        (self.folder / "power.json").write_text(json.dumps(self.diagnosis | {"power": POWER}))
        page = self.report("--diagnosis", self.folder / "power.json")
        self.assertEqual(page.table("cause", "parameter"), [
            ["backlash", "gap", "arcmin", "0.24 (0.2 to 0.3)", "5.1 (4 and up)", "7", "9", "creep 2", "–"],
            ["creep", "share", "", "never so often", "never so often", "0", "4", "–", "too slow"]])
        self.assertTrue(any(re.search("Of 20 records without a planted effect 1 got a name", words) for words in page.words))

    def test_a_predictor_has_its_card(self):
        page = self.report("--predictor", self.folder / "exported")
        self.assertEqual(page.table("trained on"), [["<campaign>", "SIM-0001", "30"]])
        self.assertEqual(page.table("split"), [["specimen", "20", "10", "network", "k2_Nm_per_rad", "mean error (%)", "1.250"]])
        self.assertEqual(page.table("operating quantity"), [["output_torque_Nm", "39.5", "40.25"], ["temperature_degC", "not known", "not known"]])

    def test_what_is_no_paper_is_refused(self):
        other, broken, none = self.folder / "other.json", self.folder / "broken.json", self.folder / "none.json"
        other.write_text('{"rows": []}')
        broken.write_text('{"rows": [')
        for option, what, expected in ("--trip-test", "sheet of a trip test", TRIP), ("--diagnosis", "diagnosis", DIAGNOSIS):
            self.assertEqual(self.refused(option, none), f"{none}: error: cannot be read (expected {expected})\n")
            self.assertEqual(self.refused(option, broken), f"{broken}: error: is no JSON (expected {expected})\n")
            self.assertEqual(self.refused(option, other), f"{other}: error: is no {what} (expected {expected})\n")
        self.assertEqual(self.refused("--predictor", self.campaign), f"{self.campaign}: error: is no predictor (expected {PREDICTOR})\n")
        export(self.folder / "changed", CARD)
        card = self.folder / "changed/model_card.json"
        card.write_text(card.read_text() + " ")
        self.assertEqual(self.refused("--predictor", self.folder / "changed"),
                         f"{card}: error: the file has changed since it was written (expected the SHA-256 that recipe.json has of it)\n")
        (self.folder / "changed/recipe.json").write_text("[]")
        self.assertEqual(self.refused("--predictor", self.folder / "changed"),
                         f"{self.folder / 'changed/recipe.json'}: error: is no recipe of a predictor (expected {PREDICTOR})\n")
        export(self.folder / "bare", {"exported_utc": ""})
        self.assertEqual(self.refused("--predictor", self.folder / "bare"),
                         f"{self.folder / 'bare'}: error: is no predictor (expected {PREDICTOR})\n")


if __name__ == "__main__":
    PROGRAM, SCHEDULE = sys.argv.pop(1), sys.argv.pop(1)
    unittest.main()
