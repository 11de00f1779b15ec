#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave train` on records that carry their labels: values, classes, and what is refused.

usage: labelled_records_test.py PROGRAM     exit code 77: skipped, there is no NumPy"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "peers"))
import needed  # noqa: E402

with needed.peers():
    import numpy

PROGRAM, FOLDER = "", pathlib.Path()
RATE_HZ, SPEED_RPM, SAMPLES = 4096, 1200, 16384
CLASSES = ("cracked", "sound", "worn")


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def signal(seed, order, height, rate_hz=RATE_HZ, samples=SAMPLES):
    """A tone at an order of the shaft in noise; the height of the tone is what tells."""
    random = numpy.random.default_rng(seed)
    time_s = numpy.arange(samples) / rate_hz
    tone = height * numpy.sin(2 * numpy.pi * order * SPEED_RPM / 60 * time_s + random.uniform(0, 6))
    return tone + 0.3 * random.standard_normal(samples)


def write(path, columns, **metadata):
    path.parent.mkdir(parents=True, exist_ok=True)
    metadata = {"kind": "vibration", "sample_rate_hz": RATE_HZ, "input_speed_rpm": SPEED_RPM} | metadata
    lines = [f"# {key}: {value}" for key, value in metadata.items() if value is not None] + [",".join(columns)]
    lines += [",".join(f"{value:.6g}" for value in row) for row in zip(*columns.values(), strict=True)]
    path.write_text("\n".join(lines) + "\n")
    return path


def class_record(path, number, name, **metadata):
    order = 3 + 4 * CLASSES.index(name)
    return write(path, {"accel_x_m_per_s2": signal(number, order, 1.0),
                        "motor_current_A": signal(100 + number, order, 0.5)}, **({"class": name} | metadata))


def value_record(path, number, **metadata):
    height = 0.5 + 0.1 * number
    return write(path, {"accel_x_m_per_s2": signal(number, 5, height)},
                 **({"k2_Nm_per_rad": 20000 - 1000 * height, "e_max_arcmin": 1 + height} | metadata))


class LabelledRecords(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        for number in range(9):
            class_record(FOLDER / "classes" / f"{number}.csv", number, CLASSES[number % 3])
            value_record(FOLDER / "values" / f"{number}.csv", number)
        code, out, error = run("train", FOLDER / "classes", "--out", FOLDER / "classifier", "--set", "orders", "--json")
        assert code == 0, error
        cls.report = json.loads(out)
        code, _, error = run("export", FOLDER / "classifier", "--out", FOLDER / "exported")
        assert code == 0, error

    def refusal(self, *arguments):
        code, out, error = run(*arguments)
        self.assertEqual((code, out), (2, ""), error)
        return error.strip().replace(str(FOLDER) + "/", "")

    def train_refusal(self, *arguments):
        refusal = self.refusal("train", *arguments, "--out", FOLDER / "none")
        self.assertFalse((FOLDER / "none").exists())
        return refusal

    def test_classes_are_told_apart_on_files_that_were_not_seen(self):
        self.assertEqual(self.report["predicts"], "classes")
        names = [split["split"] for split in self.report["splits"]]
        self.assertEqual(names, ["unseen specimens", "last part of each life", "random"])
        folds = self.report["folds"]["network"]
        self.assertEqual(list(folds["confusion"]), sorted(CLASSES))
        self.assertGreater(folds["accuracy_percent"], 90)
        windows = sum(sum(row.values()) for row in folds["confusion"].values())
        self.assertEqual(windows, self.report["records"])
        self.assertTrue((FOLDER / "classifier" / "confusion.svg").exists())

    def test_no_file_stands_on_both_sides_of_the_honest_split(self):
        per_file = {source["records"] for source in self.report["campaigns"]}
        self.assertEqual(len(per_file), 1)
        unseen = self.report["splits"][0]
        self.assertEqual(unseen["test"] % per_file.pop(), 0)

    def test_windows_are_whole_turns(self):
        recipe = json.loads((FOLDER / "classifier" / "predictor.json").read_text())["recipe"]
        self.assertEqual(recipe["window"]["samples"], 0)
        turn = RATE_HZ * 60 / SPEED_RPM
        self.assertEqual(recipe["least_samples"], int(recipe["window"]["turns"] * turn))
        self.assertEqual(recipe["channels"], ["accel_x_m_per_s2", "motor_current_A"])

    def test_a_record_that_was_not_seen_gets_probabilities(self):
        path = class_record(FOLDER / "new.csv", 77, "worn")
        code, out, error = run("predict", FOLDER / "classifier", path, "--json")
        self.assertEqual(code, 0, error)
        prediction = json.loads(out)
        self.assertEqual((prediction["class"], prediction["measured"]), ("worn", "worn"))
        self.assertAlmostEqual(sum(prediction["probabilities"].values()), 1.0, places=9)

    def test_the_export_ends_in_a_softmax_and_names_its_classes(self):
        recipe = json.loads((FOLDER / "exported" / "recipe.json").read_text())
        self.assertEqual((recipe["predicts"], recipe["outputs"]), ("classes", sorted(CLASSES)))
        self.assertIn(b"Softmax", (FOLDER / "exported" / "model.onnx").read_bytes())
        self.assertIn("| cracked | sound | worn |", (FOLDER / "exported" / "model_card.md").read_text())

    def test_a_monitor_tells_the_class_that_predict_tells(self):
        path = class_record(FOLDER / "streamed.csv", 78, "cracked")
        code, out, error = run("monitor", FOLDER / "exported", "--replay", path, "--pace", "max", "--json")
        self.assertEqual(code, 0, error)
        windows = [json.loads(line) for line in out.splitlines()]
        for told in windows:
            self.assertEqual((told["class"], told["status"]), ("cracked", "good"))
            self.assertNotIn("values", told)
            self.assertAlmostEqual(sum(told["probabilities"].values()), 1.0, places=5)
        # The windows are those of the training: as many as `predict` has, and in their mean the same.
        predicted = json.loads(run("predict", FOLDER / "classifier", path, "--json")[1])
        self.assertEqual(len(windows), predicted["windows"])
        for name, probability in predicted["probabilities"].items():
            mean = sum(told["probabilities"][name] for told in windows) / len(windows)
            self.assertAlmostEqual(mean, probability, delta=1e-5)
        code, out, _ = run("monitor", FOLDER / "exported", "--replay", path, "--pace", "max")
        self.assertRegex(out, r"  ok  class cracked \([01]\.\d{3}\)\n$")
        limits = FOLDER / "limits.yaml"
        limits.write_text("monitor: 1\nthresholds:\n  - output: worn\n    warning_above: 0.5\n")
        self.assertEqual(self.refusal("monitor", FOLDER / "exported", "--replay", path, "--settings", limits),
                         "error: a threshold is for 'worn' (expected none: the predictor tells classes)")

    def test_values_by_order_with_a_search_and_a_learning_curve(self):
        out = FOLDER / "by_order"
        code, text, error = run("train", FOLDER / "values", "--out", out, "--set", "orders", "--search",
                                "--learning-curve", "--epochs", 20, "--members", 1)
        self.assertEqual(code, 0, error)
        self.assertEqual(len(re.findall(r", decay ", text)), 8)
        self.assertRegex(text, r"(?m)^ +20 +[\d.]+ +[\d.]+$")
        self.assertTrue((out / "learning_curve.svg").exists())
        description = json.loads((out / "predictor.json").read_text())
        self.assertEqual(description["recipe"]["set"], "orders")
        self.assertEqual(description["outputs"], ["e_max_arcmin", "k2_Nm_per_rad"])
        winner = description["training"]["search"][0]["hidden"]
        layers = [layer["dense"] for layer in description["network"]["layers"]]
        self.assertEqual(layers, [*winner, 2])

    def test_labels_may_stand_in_columns(self):
        folder = FOLDER / "columns"
        for number in range(4):
            column = numpy.full(SAMPLES, 20000.0 + number)
            write(folder / f"{number}.csv", {"accel_x_m_per_s2": signal(number, 5, 1), "k2_Nm_per_rad": column})
        code, out, error = run("train", folder, "--out", FOLDER / "from_columns", "--epochs", 2, "--json")
        self.assertEqual(code, 0, error)
        self.assertIn("k2_Nm_per_rad", json.loads(out)["splits"][0]["scores"]["mean"])

    def test_a_whole_multiple_of_the_rate_is_brought_down_when_asked_for(self):
        fast = {"accel_x_m_per_s2": signal(5, 3, 1.0, 4 * RATE_HZ, 4 * SAMPLES)}
        path = write(FOLDER / "rates" / "fast.csv", fast, sample_rate_hz=4 * RATE_HZ, **{"class": "cracked"})
        slow = class_record(FOLDER / "rates" / "slow.csv", 1, "sound")
        arguments = ("--channels", "accel_x_m_per_s2", "--out", FOLDER / "rated", "--epochs", 30)
        code, _, error = run("train", path, slow, "--rate", RATE_HZ, *arguments, "--window", 0.1)
        self.assertEqual(code, 0, error)
        code, out, error = run("predict", FOLDER / "rated", path, "--json")
        self.assertEqual(code, 0, error)
        self.assertEqual(json.loads(out)["class"], "cracked")
        self.assertEqual(self.train_refusal(slow, path, "--channels", "accel_x_m_per_s2"),
                         "rates/fast.csv: error: the sampling rate is 16384 Hz (expected 4096 Hz, as in "
                         "rates/slow.csv; --rate HZ brings whole multiples down to one rate)")

    def test_records_that_do_not_fit_together_are_refused(self):
        one = value_record(FOLDER / "unlike" / "one.csv", 1)
        other = write(FOLDER / "unlike" / "other.csv", {"accel_y_m_per_s2": signal(1, 5, 1)}, k2_Nm_per_rad=1)
        self.assertEqual(self.train_refusal(one, other),
                         "unlike/other.csv: error: there is no channel accel_x_m_per_s2 (expected accel_x_m_per_s2; "
                         "--channels names those to take)")
        more = write(FOLDER / "unlike" / "more.csv", {"accel_x_m_per_s2": signal(1, 5, 1),
                                                      "accel_y_m_per_s2": signal(1, 5, 1)}, k2_Nm_per_rad=1)
        self.assertEqual(self.train_refusal(one, more),
                         "unlike/more.csv: error: there is a channel accel_y_m_per_s2 (expected accel_x_m_per_s2, as "
                         "in unlike/one.csv; --channels names those to take)")

    def test_labels_that_teach_nothing_are_refused(self):
        none = write(FOLDER / "none.csv", {"accel_x_m_per_s2": signal(1, 5, 1)})
        self.assertEqual(self.train_refusal(none),
                         "none.csv: error: no record has a label (expected metadata or a column with e_max_arcmin, "
                         "e_avg_arcmin, k1_Nm_per_rad, k2_Nm_per_rad, k3_Nm_per_rad or class)")
        equal = [value_record(FOLDER / "equal" / f"{number}.csv", number, k2_Nm_per_rad=7) for number in range(6)]
        self.assertEqual(self.train_refusal(*equal, "--outputs", "k2_Nm_per_rad"),
                         "equal/0.csv: error: k2_Nm_per_rad is 7 in every record (expected something that changes "
                         "over the records)")
        alike = [class_record(FOLDER / "alike" / f"{number}.csv", number, "sound") for number in range(6)]
        self.assertEqual(self.train_refusal(*alike),
                         "alike/0.csv: error: the class is sound in every record (expected records of two classes or "
                         "more)")
        word = value_record(FOLDER / "word.csv", 1, k2_Nm_per_rad="stiff")
        self.assertEqual(self.train_refusal(word),
                         "word.csv:4:18: error: k2_Nm_per_rad is 'stiff' (expected a number)")
        self.assertEqual(self.train_refusal(word, "--outputs", "class", "k2_Nm_per_rad"),
                         "error: class and quantities in one predictor (expected class alone, or without it)")

    def test_records_without_a_label_or_with_a_dead_sensor_are_left_out_with_a_note(self):
        folder = FOLDER / "some"
        for number in range(6):
            value_record(folder / f"{number}.csv", number)
        value_record(folder / "bare.csv", 7, k2_Nm_per_rad=None)
        write(folder / "dead.csv", {"accel_x_m_per_s2": numpy.zeros(SAMPLES)}, k2_Nm_per_rad=3, e_max_arcmin=1)
        code, out, error = run("train", folder, "--out", FOLDER / "from_some", "--epochs", 2, "--json")
        self.assertEqual(code, 0, error)
        notes = [note.replace(str(FOLDER) + "/", "") for note in json.loads(out)["notes"]]
        self.assertIn("some/bare.csv: error: left out: there is no k2_Nm_per_rad", notes)
        self.assertIn("some/dead.csv: error: accel_x_m_per_s2 is 0 throughout (expected a signal: is the sensor "
                      "connected?); left out", notes)

    def test_too_few_and_too_short_records_are_refused(self):
        few = [value_record(FOLDER / "few" / f"{number}.csv", number) for number in range(3)]
        self.assertEqual(self.train_refusal(*few, "--window", 0),
                         "few/0.csv: error: 3 windows with vibration and e_max_arcmin, k2_Nm_per_rad (expected at "
                         "least 20)")
        self.assertRegex(self.train_refusal(*few, "--window", 60),
                         r"^few/0.csv: error: 0 windows with vibration and e_max_arcmin, k2_Nm_per_rad; few/0.csv: "
                         r"error: 16384 samples \(expected at least one window of 1200 turns\); left out \(expected at "
                         r"least 20\)$")
        short = write(FOLDER / "short.csv", {name: signal(1, 3, 1, samples=500)
                                             for name in ("accel_x_m_per_s2", "motor_current_A")})
        self.assertRegex(self.refusal("predict", FOLDER / "classifier", short),
                         r"^short.csv: error: 500 samples \(expected at least \d+, as in training\)$")

    def test_a_record_with_nan_or_without_a_speed_is_refused(self):
        path = class_record(FOLDER / "nan.csv", 3, "worn")
        lines = path.read_text().splitlines()
        lines[10] = "nan," + lines[10].split(",")[1]
        path.write_text("\n".join(lines) + "\n")
        self.assertRegex(self.train_refusal(path), r"^nan.csv:11:1: error: ")
        still = class_record(FOLDER / "still.csv", 3, "worn", input_speed_rpm=None)
        self.assertRegex(self.refusal("predict", FOLDER / "classifier", still),
                         r"^still.csv: error: there is no steady speed of the input shaft \(expected one, for windows "
                         r"of \d+ turns, as in training\)$")


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    with tempfile.TemporaryDirectory() as folder:
        FOLDER = pathlib.Path(folder)
        unittest.main()
