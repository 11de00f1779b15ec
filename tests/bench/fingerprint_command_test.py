#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave simulate --study arm` and `strainwave fingerprint`: from a simulated data set to verdicts, other people's
data sets, and what is refused.

usage: fingerprint_command_test.py PROGRAM"""
import json
import math
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM, FOLDER = "", pathlib.Path()
SPLITS = ["random", "file_left_out", "unit_left_out", "origin_left_out"]
KINDS = ["network", "forest", "svm", "logistic_regression"]
QUICK = ("--epochs", 20, "--samples", 20, "--background", 10)


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def swinging(seed, drag_Nm, joints=2, rows=600, rate_hz=200, acceleration=False):
    """Joints that swing against inertia and friction; the first drags where there is a fault."""
    draw = random.Random(seed)
    names = ["time_s"]
    for j in range(1, joints + 1):
        names += [f"q{j}_rad", f"qd{j}_rad_per_s", f"tau{j}_Nm"] + ([f"qdd{j}_rad_per_s2"] if acceleration else [])
    lines = ["# kind: joints", ",".join(names)]
    pace = [draw.uniform(2, 4) for _ in range(joints)]
    friction = [draw.uniform(0.9, 1.1) for _ in range(joints)]
    for i in range(rows):
        t = i / rate_hz
        row = [t]
        for j in range(joints):
            q, qd, qdd = (math.sin(pace[j] * t), pace[j] * math.cos(pace[j] * t), -pace[j] ** 2 * math.sin(pace[j] * t))
            lost = friction[j] + (drag_Nm if j == 0 else 0)
            row += [q, qd, qdd + 3 * math.cos(q) + lost * math.tanh(20 * qd) + draw.gauss(0, 0.05)]
            row += [qdd] if acceleration else []
        lines.append(",".join(f"{value:.6g}" for value in row))
    return "\n".join(lines) + "\n"


def data_set(folder, files, columns=("class", "origin"), **options):
    """files: (class, unit, origin, drag)."""
    folder.mkdir(parents=True)
    rows = ["file,unit," + ",".join(columns)]
    for number, (name, unit, origin, drag_Nm) in enumerate(files):
        (folder / f"{number}.csv").write_text(swinging(number, drag_Nm, **options))
        values = {"class": name, "origin": origin}
        rows.append(",".join([f"{number}.csv", unit, *(values[column] for column in columns)]))
    (folder / "labels.csv").write_text("\n".join(rows) + "\n")
    return folder


def two_kinds(good="Normal", bad="Brake"):
    return [(bad if i % 2 else good, f"u{i}", "lab" if i < 4 else "line", 1.5 if i % 2 else 0.0) for i in range(8)]


class Fingerprint(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = data_set(FOLDER / "swinging", two_kinds())
        code, out, cls.words = run("fingerprint", "train", cls.folder, "--out", FOLDER / "model", "--json", *QUICK)
        assert code == 0, cls.words
        cls.report = json.loads(out)

    def refusal(self, *arguments):
        code, out, error = run(*arguments)
        self.assertEqual((code, out), (2, ""), error)
        return error.strip().replace(str(FOLDER) + "/", "")

    def train_refusal(self, *arguments):
        refusal = self.refusal("fingerprint", "train", *arguments, "--out", FOLDER / "none")
        self.assertFalse((FOLDER / "none").exists())
        return refusal

    def test_the_study_is_the_same_for_the_same_seed(self):
        for name in ("one", "two"):
            code, out, error = run("simulate", "--study", "arm", "--out", FOLDER / name, "--seed", 3, "--units", 1, "--json")
            self.assertEqual(code, 0, error)
        told = json.loads(out)
        self.assertEqual(told["labels"], ["class", "origin", "fault", "joint", "payload_kg", "speed_share"])
        files = sorted(path.name for path in (FOLDER / "one").iterdir())
        # One unit a condition, and each faulty one was seen healthy before.
        self.assertEqual((len(files), told["units"]), (7, 4))
        for name in files:
            self.assertEqual((FOLDER / "one" / name).read_bytes(), (FOLDER / "two" / name).read_bytes())
        code, _, error = run("simulate", "--study", "arm", "--out", FOLDER / "other", "--seed", 4, "--units", 1)
        self.assertEqual(code, 0, error)
        self.assertNotEqual((FOLDER / "one" / "001.csv").read_bytes(), (FOLDER / "other" / "001.csv").read_bytes())

    def test_every_model_is_scored_on_every_split(self):
        for table in ("raw", "fingerprint", "fingerprint_per_file"):
            self.assertEqual(list(self.report[table]), KINDS)
            for kind in KINDS:
                self.assertEqual(list(self.report[table][kind]), SPLITS)
                for split, score in self.report[table][kind].items():
                    self.assertLessEqual(score["low"], score["accuracy"], (table, kind, split))
                    self.assertGreaterEqual(score["high"], score["accuracy"])
                    self.assertTrue(0 <= score["auc"] <= 1)
                    self.assertEqual(score["cases"], 160 if split == "random" else 8)
        self.assertEqual(list(self.report["shuffled_labels"]), SPLITS)
        excess = self.report["excess_friction"]
        self.assertEqual(list(excess), SPLITS)
        self.assertEqual((excess["random"]["accuracy"], excess["random"]["reason"]), (None, "it is told of whole files"))
        # Four healthy files: with a fold of two left out, two are left.
        self.assertEqual(excess["origin_left_out"]["reason"], "with a fold left out, fewer than 3 healthy files are left")
        self.assertGreater(excess["unit_left_out"]["auc"], 0.8)
        self.assertGreater(self.report["fingerprint"]["network"]["unit_left_out"]["accuracy"], 0.8)
        self.assertLess(self.report["fingerprint_is"]["sums_within"], 1e-9)
        self.assertEqual(self.report["healthy_class"], "Normal")
        self.assertIn("no unit was seen both healthy and faulty", self.words)

    def test_a_drag_is_found_in_the_joint_that_has_it(self):
        for drag_Nm, name in ((1.5, "faulty"), (0.0, "Normal")):
            path = FOLDER / f"new_{drag_Nm}.csv"
            path.write_text(swinging(77, drag_Nm))
            code, out, error = run("fingerprint", "classify", FOLDER / "model", path, "--json")
            self.assertEqual(code, 0, error)
            (told,) = json.loads(out)
            self.assertEqual((told["file"], told["class"]), (str(path), name))
            self.assertEqual(list(told["attribution"]), ["joint1", "joint2"])
            gained = told["probability"] - told["healthy_probability"]
            self.assertAlmostEqual(sum(told["attribution"].values()), gained, places=9)
            if drag_Nm:
                self.assertGreater(told["attribution"]["joint1"], abs(told["attribution"]["joint2"]))

    def test_the_export_says_what_it_is_and_what_it_is_worth(self):
        code, out, error = run("fingerprint", "export", FOLDER / "model", "--out", FOLDER / "exported")
        self.assertEqual(code, 0, error)
        self.assertRegex(out, r"read back by OpenCV dnn: agrees to \d")
        recipe = json.loads((FOLDER / "exported" / "recipe.json").read_text())
        self.assertEqual(recipe["states"], ["q1", "q2", "qd1", "qd2", "qdd1", "qdd2"])
        self.assertEqual(len(recipe["self_test"]["nominal"][0]["prediction"]), 2)
        self.assertIn("| unit_left_out |", (FOLDER / "exported" / "model_card.md").read_text())

    def monitored(self, model, name, *paths):
        code, _, error = run("fingerprint", "export", model, "--out", FOLDER / name)
        self.assertEqual(code, 0, error)
        code, out, error = run("monitor", FOLDER / name, "--replay", *paths, "--pace", "max", "--json")
        return code, [json.loads(line) for line in out.splitlines()], error

    def test_a_monitor_runs_the_export_as_classify_does(self):
        paths = [FOLDER / "dragging.csv", FOLDER / "sound.csv"]
        for path, drag_Nm in zip(paths, (1.5, 0.0), strict=True):
            path.write_text(swinging(78, drag_Nm))
        code, out, error = run("fingerprint", "classify", FOLDER / "model", *paths, "--json")
        self.assertEqual(code, 0, error)
        code, windows, error = self.monitored(FOLDER / "model", "monitored", *paths)
        self.assertEqual((code, len(windows)), (0, 2), error)
        for told, window in zip(json.loads(out), windows, strict=True):
            self.assertAlmostEqual(window["probabilities"]["faulty"], told["probability"], delta=1e-4)
            self.assertEqual((window["class"], window["status"]), (told["class"], "good"))

    def test_a_monitor_says_what_a_stream_of_joints_lacks(self):
        # Of one joint more, which is no harm; a torque that is not connected; another rate; another kind.
        unlike = {"three.csv": (0, swinging(5, 0, joints=3)), "dead.csv": (2, "tau2_Nm is 0 throughout"),
                  "slow.csv": (2, "the sampling rate is 100 Hz (expected 200 Hz, as in training)"),
                  "loop.csv": (2, "kind is hysteresis (expected joints)")}
        lines = swinging(5, 0).splitlines()
        (FOLDER / "three.csv").write_text(unlike["three.csv"][1])
        (FOLDER / "dead.csv").write_text("\n".join(lines[:2] + [line.rsplit(",", 1)[0] + ",0" for line in lines[2:]]) + "\n")
        (FOLDER / "slow.csv").write_text(swinging(5, 0, rate_hz=100))
        (FOLDER / "loop.csv").write_text("# kind: hysteresis\ntime_s,torque_Nm,output_angle_deg\n0,0,0\n1,1,0.1\n2,0,0\n")
        for name, (expected, words) in unlike.items():
            code, _, error = self.monitored(FOLDER / "model", "judged", FOLDER / name)
            self.assertEqual(code, expected, error)
            if expected:
                self.assertIn(words, error)

    def test_a_monitor_refuses_an_export_that_was_changed_or_cannot_be_run(self):
        self.monitored(FOLDER / "model", "to_change", self.folder / "0.csv")
        network = FOLDER / "to_change" / "nominal.onnx"
        network.write_bytes(network.read_bytes()[:-1] + b"?")
        self.assertEqual(self.refusal("monitor", FOLDER / "to_change", "--replay", self.folder / "0.csv"),
                         "to_change/nominal.onnx: error: the file has changed since it was written (expected the SHA-256 "
                         "that recipe.json has of it)")
        code, _, error = run("fingerprint", "train", self.folder, "--out", FOLDER / "by_gradients", *QUICK, "--fingerprint",
                             "group", "--method", "gradients")
        self.assertEqual(code, 0, error)
        code, _, error = self.monitored(FOLDER / "by_gradients", "gradients", self.folder / "0.csv")
        self.assertEqual((code, error.replace(str(FOLDER) + "/", "")),
                         (2, "gradients/recipe.json: error: its fingerprints are expected gradients, which an exported network "
                             "does not give (expected a model that was trained with --method exact or kernel)\n"))

    def test_the_same_seed_gives_the_same_model(self):
        code, _, error = run("fingerprint", "train", self.folder, "--out", FOLDER / "again", *QUICK)
        self.assertEqual(code, 0, error)
        self.assertEqual((FOLDER / "model" / "numbers.h5").read_bytes(), (FOLDER / "again" / "numbers.h5").read_bytes())

    def test_other_peoples_data_sets(self):
        # One joint with accelerations, three classes in another order of columns, no origin; five files.
        folder = data_set(FOLDER / "one_joint", [("ok", "a", "", 0), ("brake", "b", "", 2), ("ok", "c", "", 0),
                                                 ("worn", "d", "", 3), ("ok", "e", "", 0)], columns=("class",), joints=1,
                          acceleration=True)
        code, out, error = run("fingerprint", "train", folder, "--out", FOLDER / "one_joint_model", "--json", *QUICK)
        self.assertEqual(code, 0, error)
        report = json.loads(out)
        self.assertEqual(report["filter"]["acceleration"], "measured")
        self.assertEqual(report["raw"]["forest"]["origin_left_out"]["reason"], "labels.csv has no column origin")
        self.assertIn("3 classes: all but 'ok' count as faulty", error)
        code, out, error = run("fingerprint", "classify", FOLDER / "one_joint_model", folder, "--json")
        self.assertEqual((code, len(json.loads(out))), (0, 5), error)

    def test_one_file_of_each_class_is_a_limit_that_is_told(self):
        folder = data_set(FOLDER / "pair", [("normal", "a", "x", 0), ("faulty", "b", "y", 2)])
        code, out, error = run("fingerprint", "train", folder, "--out", FOLDER / "pair_model", "--json", *QUICK)
        self.assertEqual(code, 0, error)
        told = json.loads(out)["fingerprint"]["forest"]["file_left_out"]
        self.assertIsNone(told["accuracy"])
        self.assertRegex(told["reason"], r"with fold \d of 2 left out, no (healthy|faulty) file is left to train on")
        self.assertIn("too few healthy files to leave one out", error)

    def test_fingerprints_of_single_inputs(self):
        for kind, method in (("group", "kernel"), ("tensor", "gradients")):
            code, out, error = run("fingerprint", "train", self.folder, "--out", FOLDER / kind, "--json", *QUICK,
                                   "--fingerprint", kind, "--method", method)
            self.assertEqual(code, 0, error)
            told = json.loads(out)
            self.assertEqual((told["fingerprint_is"]["name"], told["fingerprint_is"]["method"]), (kind, method))
            self.assertEqual(len(told["fingerprint_is"]["per_file_numbers"]), 6 if kind == "group" else 12)
            self.assertAlmostEqual(sum(told["dynamics"][0]["share"].values()), 1, places=9)

    def test_labels_that_teach_nothing_are_refused(self):
        alike = data_set(FOLDER / "alike", [("normal", f"u{i}", "x", 0) for i in range(3)])
        self.assertEqual(self.train_refusal(alike),
                         "alike/labels.csv: error: every file is of the class 'normal' (expected two classes or more: what "
                         "healthy units have can only be told beside faulty ones)")
        (alike / "labels.csv").write_text("file,unit,class\n0.csv,a,normal\n1.csv,b,\n")
        self.assertEqual(self.train_refusal(alike), "alike/labels.csv:3:9: error: class is empty (expected a name in every row)")
        (alike / "labels.csv").write_text("file,unit\n0.csv,a\n")
        self.assertEqual(self.train_refusal(alike),
                         "alike/labels.csv:1:1: error: column 'class' is missing (expected it beside file, unit)")
        self.assertEqual(self.train_refusal(self.folder, "--healthy", "fine"),
                         "--healthy: error: no file is of the class 'fine' (expected Brake, Normal)")

    def test_records_that_do_not_fit_are_refused(self):
        folder = data_set(FOLDER / "unlike", two_kinds())
        (folder / "5.csv").write_text(swinging(5, 0, joints=3))
        self.assertEqual(self.train_refusal(folder), "unlike/5.csv: error: has 3 joints (expected 2, as 0.csv has)")
        (folder / "5.csv").write_text(swinging(5, 0, rows=21))
        self.assertEqual(self.train_refusal(folder),
                         "unlike/5.csv: error: 21 samples, less than two windows of 11 (0.055 s at 200 Hz) (expected 22 or "
                         "more, or a shorter --window)")
        self.assertEqual(self.train_refusal(self.folder, "--window", 0.5),
                         "swinging/0.csv: error: a window of 0.5 s is 100 samples at 200 Hz (expected an odd number, so that "
                         "it has a middle, for instance 0.505 s)")
        other = FOLDER / "three.csv"
        other.write_text(swinging(5, 0, joints=3))
        self.assertEqual(self.refusal("fingerprint", "classify", FOLDER / "model", other),
                         "three.csv: error: has 3 joints (expected 2, as the model)")

    def test_a_model_that_was_changed_is_refused(self):
        changed = FOLDER / "changed"
        shutil.copytree(FOLDER / "model", changed)
        text = (changed / "fingerprint.json").read_text()
        (changed / "fingerprint.json").write_text(text.replace('"order": 3', '"order": 2', 1))
        self.assertEqual(self.refusal("fingerprint", "classify", changed, self.folder / "0.csv"),
                         "changed/fingerprint.json: error: the file has changed since it was written (expected the SHA-256 "
                         "that it has of itself)")
        self.assertEqual(self.refusal("fingerprint", "classify", FOLDER / "missing", self.folder / "0.csv"),
                         "missing/fingerprint.json: error: cannot be read (expected a model as `strainwave fingerprint "
                         "train` writes it)")

    def test_options_that_do_not_go_together_are_refused(self):
        self.assertEqual(self.train_refusal(self.folder, "--fingerprint", "all"),
                         "--fingerprint: error: 'all' is no fingerprint (expected joint, group or tensor)")
        self.assertEqual(self.train_refusal(self.folder, "--method", "gradients"),
                         "--method: error: expected gradients are of single inputs (expected --fingerprint group or tensor "
                         "with it)")


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    with tempfile.TemporaryDirectory() as folder:
        FOLDER = pathlib.Path(folder)
        unittest.main()
