#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave train`, `predict` and `export` as a user would, on a short campaign.

usage: predictor_commands_test.py PROGRAM     exit code 77: skipped, there is no h5py or NumPy"""
import hashlib
import json
import pathlib
import re
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "peers"))
import needed  # noqa: E402

with needed.peers():
    import h5py
    import numpy

PROGRAM, FOLDER = "", pathlib.Path()
QUICK = pathlib.Path(__file__).resolve().parents[2] / "schedules" / "quick.yaml"
CHANNELS = ["accel_x_m_per_s2", "accel_y_m_per_s2", "accel_z_m_per_s2", "accel_motor_z_m_per_s2"]
CYCLES = 30


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def campaign(name, cycles):
    text, replaced = re.subn(r"^cycles: \d+", f"cycles: {cycles}", QUICK.read_text(), flags=re.M)
    assert replaced == 1
    schedule = FOLDER / f"{name}.yaml"
    schedule.write_text(text)
    code, _, error = run("run", schedule, "--out", FOLDER / name)
    assert code == 0, error
    return FOLDER / name


def vibration(cycle):
    with h5py.File(FOLDER / "campaign" / "cycles" / f"{cycle:06d}.h5") as file:
        record = file["measurement_rotation/vibration"]
        return {channel: record[channel][:].astype(float) for channel in CHANNELS}


def write(name, columns, rate_hz=25600.0):
    lines = ["# kind: vibration", f"# sample_rate_hz: {rate_hz}", "# input_speed_rpm: 2400", ",".join(columns)]
    lines += [",".join(map(repr, map(float, row))) for row in zip(*columns.values(), strict=True)]
    (FOLDER / name).write_text("\n".join(lines) + "\n")
    return FOLDER / name


class Predictors(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.campaign = campaign("campaign", CYCLES)
        cls.predictor = FOLDER / "predictor"
        code, out, error = run("train", cls.campaign, "--out", cls.predictor, "--epochs", 40, "--json")
        assert code == 0, error
        cls.report = json.loads(out)

    def refusal(self, *arguments):
        code, out, error = run(*arguments)
        self.assertEqual((code, out), (2, ""), error)
        return error.strip().replace(str(FOLDER) + "/", "")

    def test_training_reports_honest_splits_and_a_random_one_beside_them(self):
        self.assertEqual([split["split"] for split in self.report["splits"]], ["last part of each life", "random"])
        for split in self.report["splits"]:
            self.assertEqual(list(split["scores"]), ["network", "ridge", "forest", "cycle number alone", "mean"])
            self.assertEqual(split["train"] + split["test"], CYCLES)
        self.assertEqual(self.report["campaigns"][0]["specimen"], "SIM-0001")
        # The folds compare the same, over all records.
        folds = self.report["folds"]
        self.assertEqual(list(folds["scores"]), ["network", "ridge", "forest", "cycle number alone", "mean"])
        self.assertEqual(folds["scores"]["network"], folds["network"])
        errors = [scores["mean_mape_percent"] for scores in folds["scores"].values()]
        self.assertEqual(len(set(errors)), 5)
        kept = self.report["filter"]
        self.assertEqual((kept["vibration_features"], kept["torque_features"]), (980, 245))
        self.assertLess(kept["vibration_kept"], 980)

    def test_features_are_kept_with_the_data_under_their_names(self):
        with h5py.File(self.campaign / "features.h5") as file:
            self.assertEqual(list(file["cycle"][:]), list(range(1, CYCLES + 1)))
            names = set(file) - {"cycle"}
            self.assertEqual(len(names), 980 + 245)
            self.assertTrue(all(re.fullmatch(r"\w+\.a[1-7]\..+", name) for name in names), sorted(names)[:3])
            self.assertTrue((file["accel_x_m_per_s2.a1.root_mean_square"][:] > 0).all())
        before = hashlib.sha256((self.campaign / "features.h5").read_bytes()).hexdigest()
        again = FOLDER / "again"
        code, _, error = run("train", self.campaign, "--out", again, "--epochs", 40)
        self.assertEqual(code, 0, error)
        self.assertEqual(hashlib.sha256((self.campaign / "features.h5").read_bytes()).hexdigest(), before)
        # The same campaign and seed: the same numbers, on however many threads.
        self.assertEqual((again / "numbers.h5").read_bytes(), (self.predictor / "numbers.h5").read_bytes())

    def test_predictions_are_near_what_was_measured(self):
        code, out, error = run("predict", self.predictor, self.campaign / "cycles" / "000010.h5", "--json")
        self.assertEqual(code, 0, error)
        prediction = json.loads(out)
        self.assertFalse(prediction["outside_training"])
        with sqlite3.connect(self.campaign / "campaign.db") as database:
            measured = dict(database.execute("SELECT quantity, value FROM results WHERE cycle = 10 AND repeat = 0"))
        self.assertEqual(len(prediction["values"]), 5)
        for quantity, value in prediction["values"].items():
            self.assertLess(value["low"], value["value"])
            self.assertLess(value["value"], value["high"])
            self.assertAlmostEqual(value["value"] / measured[quantity], 1.0, delta=0.05)

    def test_a_csv_is_predicted_as_the_campaign_s_own_record(self):
        path = write("ten.csv", vibration(10))
        _, from_csv, _ = run("predict", self.predictor, path, "--json")
        _, from_cycle, _ = run("predict", self.predictor, self.campaign / "cycles" / "000010.h5", "--json")
        self.assertEqual(json.loads(from_csv)["values"], json.loads(from_cycle)["values"])

    def test_the_motor_s_torque_is_a_channel_that_the_recipe_states(self):
        out = FOLDER / "by_order"
        code, _, error = run("train", self.campaign, "--out", out, "--epochs", 10, "--set", "orders", "--motor-torque")
        self.assertEqual(code, 0, error)
        recipe = json.loads((out / "predictor.json").read_text())["recipe"]
        self.assertEqual(recipe["set"], "orders")
        self.assertEqual(sorted(recipe["channels"]), sorted([*CHANNELS, "motor_torque_Nm"]))
        code, text, error = run("predict", out, self.campaign / "cycles" / "000010.h5", "--json")
        self.assertEqual(code, 0, error)
        self.assertEqual(len(json.loads(text)["values"]), 5)
        self.assertRegex(self.refusal("predict", out, write("without.csv", vibration(10))),
                         r"^without.csv: error: there is no channel motor_torque_Nm \(expected .*\)$")

    def test_features_of_a_campaign_come_a_row_a_cycle(self):
        code, text, error = run("features", self.campaign, "--json")
        self.assertEqual(code, 0, error)
        campaign_features = json.loads(text)
        self.assertEqual([row["cycle"] for row in campaign_features["cycles"]], list(range(1, CYCLES + 1)))
        self.assertEqual(len(campaign_features["cycles"][0]["values"]), len(campaign_features["names"]))
        code, text, _ = run("features", self.campaign)
        self.assertEqual(text.replace(str(FOLDER) + "/", ""),
                         f"campaign: 1225 features of {CYCLES} cycles, in campaign/features.h5\n")

    def test_another_gear_s_sound_lies_outside(self):
        random = numpy.random.default_rng(1)
        columns = {name: 3.0 * values + random.standard_normal(len(values)) for name, values in vibration(10).items()}
        code, out, error = run("predict", self.predictor, write("loud.csv", columns), "--json")
        self.assertEqual(code, 0, error)
        self.assertTrue(json.loads(out)["outside_training"])

    def test_what_is_not_as_in_training_is_refused_in_words(self):
        good = vibration(10)
        rate = write("rate.csv", good, rate_hz=12800.0)
        self.assertEqual(self.refusal("predict", self.predictor, rate),
                         "rate.csv: error: the sampling rate is 12800 Hz (expected 25600 Hz, as in training)")
        short = write("short.csv", {name: values[:5000] for name, values in good.items()})
        self.assertRegex(self.refusal("predict", self.predictor, short),
                         r"^short.csv: error: 5000 samples \(expected at least \d+, as in training\)$")
        missing = write("missing.csv", {name: good[name] for name in CHANNELS[1:]})
        self.assertEqual(self.refusal("predict", self.predictor, missing),
                         "missing.csv: error: there is no channel accel_x_m_per_s2 (expected " +
                         ", ".join(self.channels()) + ")")
        dead = write("dead.csv", good | {"accel_y_m_per_s2": numpy.zeros(len(good["accel_y_m_per_s2"]))})
        self.assertEqual(self.refusal("predict", self.predictor, dead),
                         "dead.csv: error: accel_y_m_per_s2 is 0 throughout (expected a signal: is the sensor "
                         "connected?)")
        clipped = write("clipped.csv", good | {"accel_z_m_per_s2": numpy.clip(good["accel_z_m_per_s2"], -0.25, 0.25)})
        self.assertRegex(self.refusal("predict", self.predictor, clipped),
                         r"^clipped.csv: error: accel_z_m_per_s2 stays at its end value -?0.25 for \d+ samples "
                         r"\(expected a sensor within its range\)$")

    def channels(self):
        return json.loads((self.predictor / "predictor.json").read_text())["recipe"]["channels"]

    def test_a_predictor_that_was_changed_is_refused(self):
        changed = FOLDER / "changed"
        shutil.copytree(self.predictor, changed)
        numbers = bytearray((changed / "numbers.h5").read_bytes())
        numbers[-9] ^= 1
        (changed / "numbers.h5").write_bytes(numbers)
        self.assertEqual(self.refusal("export", changed, "--out", FOLDER / "nothing"),
                         "changed/numbers.h5: error: the file has changed since it was written (expected the SHA-256 "
                         "that predictor.json has of it)")
        self.assertFalse((FOLDER / "nothing").exists())
        self.assertEqual(self.refusal("predict", FOLDER / "none", "x.csv"),
                         "none/predictor.json: error: cannot be read (expected a predictor, as `strainwave train` "
                         "writes it)")

    def test_campaigns_that_teach_nothing_are_refused(self):
        self.assertEqual(self.refusal("train", FOLDER / "none", "--out", FOLDER / "p"),
                         "none: error: is not a campaign (expected a folder with campaign.db)")
        few = campaign("few", 5)
        self.assertEqual(self.refusal("train", few, "--out", FOLDER / "p"),
                         "few: error: 5 cycles with vibration and e_max_arcmin, e_avg_arcmin, k1_Nm_per_rad, "
                         "k2_Nm_per_rad, k3_Nm_per_rad (expected at least 20)")
        self.assertEqual(self.refusal("train", self.campaign, "--out", FOLDER / "p", "--design", "tall"),
                         "error: there is no design 'tall' (expected small, ann or cnn)")
        self.assertFalse((FOLDER / "p").exists())

    def test_a_comparison_writes_nothing(self):
        code, out, error = run("train", self.campaign, "--compare", "--epochs", 10, "--json")
        self.assertEqual(code, 0, error)
        report = json.loads(out)
        self.assertEqual([split["split"] for split in report["splits"]], ["last part of each life"])
        self.assertNotIn("folds", report)
        told = "error: a predictor is written somewhere or not at all (expected --out or --compare)"
        self.assertEqual(self.refusal("train", self.campaign), told)
        self.assertEqual(self.refusal("train", self.campaign, "--compare", "--out", FOLDER / "p"), told)

    def test_changes_since_a_baseline_need_the_reducer_s_own(self):
        predictor, exported, own = FOLDER / "changes", FOLDER / "changes_exported", FOLDER / "own.json"
        code, out, error = run("train", self.campaign, "--out", predictor, "--baseline", 3, "--epochs", 40, "--json")
        self.assertEqual(code, 0, error)
        self.assertEqual(json.loads(out)["baseline_records"], 3)
        self.assertEqual([split["train"] + split["test"] for split in json.loads(out)["splits"]], [CYCLES - 3] * 2)
        code, _, error = run("export", predictor, "--out", exported, "--anyway")
        self.assertEqual(code, 0, error)
        self.assertIn("first 3 records", (exported / "model_card.md").read_text())
        cycle = self.campaign / "cycles" / "000010.h5"
        needed = ("error: the predictor tells changes since a reducer's first 3 records (expected its baseline file, "
                  "as `strainwave baseline` writes it)")
        self.assertEqual(self.refusal("predict", predictor, cycle), needed)
        self.assertEqual(self.refusal("monitor", exported, "--replay", cycle), needed)
        for folder in predictor, exported:
            code, out, error = run("baseline", folder, self.campaign, "--out", own)
            self.assertEqual(code, 0, error)
            self.assertRegex(out, r"own.json: SIM-0001, 3 records: e_max_arcmin \S+ .* k3_Nm_per_rad \S+\n$")
        code, out, error = run("predict", predictor, cycle, "--baseline", own, "--json")
        self.assertEqual(code, 0, error)
        with sqlite3.connect(self.campaign / "campaign.db") as database:
            measured = dict(database.execute("SELECT quantity, value FROM results WHERE cycle = 10 AND repeat = 0"))
        values = json.loads(out)["values"]
        for quantity, value in values.items():
            self.assertAlmostEqual(value["value"] / measured[quantity], 1.0, delta=0.05)
        code, out, error = run("monitor", exported, "--baseline", own, "--replay", cycle, "--pace", "max", "--json")
        self.assertEqual(code, 0, error)
        for quantity, value in json.loads(out)["values"].items():
            self.assertAlmostEqual(value["value"] / values[quantity]["value"], 1.0, delta=1e-5)

    def test_a_baseline_is_of_one_reducer_and_whole(self):
        predictor, out = FOLDER / "whole", FOLDER / "whole.json"
        self.assertEqual(self.refusal("train", self.campaign, "--out", predictor, "--baseline", CYCLES),
                         f"error: baseline of {CYCLES} records: a reducer has {CYCLES} records (expected more than the "
                         f"{CYCLES} of its baseline)")
        self.assertEqual(self.refusal("train", self.campaign, "--out", predictor, "--baseline", 11),
                         "error: baseline of 11 records: 19 records remain (expected at least 20)")
        self.assertEqual(self.refusal("baseline", self.predictor, self.campaign, "--out", out),
                         "error: the predictor takes no baseline (expected one trained with --baseline)")
        code, _, error = run("train", self.campaign, "--out", predictor, "--baseline", 6, "--epochs", 10)
        self.assertEqual(code, 0, error)
        self.assertEqual(self.refusal("baseline", predictor, self.campaign / "cycles" / "000001.h5", "--out", out),
                         "campaign/cycles/000001.h5: error: 0 records with vibration and e_max_arcmin, e_avg_arcmin, "
                         "k1_Nm_per_rad, k2_Nm_per_rad, k3_Nm_per_rad; campaign/cycles/000001.h5: error: group "
                         "'/measurement_rotation/vibration': left out: there is no e_max_arcmin (expected at least the "
                         "6 of the baseline)")
        self.assertFalse(out.exists())

    def test_the_export_says_what_it_is(self):
        out = FOLDER / "exported"
        code, text, error = run("export", self.predictor, "--out", out, "--anyway")
        self.assertEqual(code, 0, error)
        agreement = re.search(r"read back by OpenCV dnn: agrees to (\S+) of each output, \S+ of its error", text)
        self.assertLessEqual(float(agreement.group(1)), 1e-5)
        recipe = json.loads((out / "recipe.json").read_text())
        self.assertEqual(recipe["model"]["sha256"], hashlib.sha256((out / "model.onnx").read_bytes()).hexdigest())
        self.assertEqual(recipe["outputs"], list(self.report["splits"][0]["scores"]["mean"])[:-1])
        card = (out / "model_card.md").read_text()
        self.assertIn("SIM-0001", card)
        self.assertIn("too few reducers", card)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    with tempfile.TemporaryDirectory() as folder:
        FOLDER = pathlib.Path(folder)
        unittest.main()
