#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave health train|assess|whatif` on records made here, and what is refused; the simulated data set.

usage: health_command_test.py PROGRAM"""
import csv
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

PROGRAM, FOLDER = "", pathlib.Path()
RATE_HZ, ROWS = 500, 400
LEVELS = (0.0, 0.5, 1.0)


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def signals(gear, belt, seed, rows=ROWS):
    """A wave of 20 Hz in the current tells the gear, noise above 125 Hz in the speed the belt."""
    draw = random.Random(seed)
    current, speed, state = [], [], []
    before = 0.0
    for i in range(rows):
        time_s = i / RATE_HZ
        noise = draw.gauss(0, 1)
        moving = 0.02 < time_s % 0.8 < 0.22 or 0.42 < time_s % 0.8 < 0.62
        current.append(math.sin(2 * math.pi * 20 * time_s) * (0.3 + gear) + 0.1 * draw.gauss(0, 1))
        speed.append((5 if time_s % 0.8 < 0.4 else -5) * moving + (0.2 + 0.5 * belt) * (noise - before))
        state.append(1 if moving else 0)
        before = noise
    return {"current_A": current, "velocity_rad_per_s": speed, "state": state}


def write(path, columns, **metadata):
    path.parent.mkdir(parents=True, exist_ok=True)
    metadata = {"kind": "motor", "sample_rate_hz": RATE_HZ} | metadata
    lines = [f"# {key}: {value}" for key, value in metadata.items() if value is not None] + [",".join(columns)]
    lines += [",".join(f"{value:.6g}" for value in row) for row in zip(*columns.values(), strict=True)]
    path.write_text("\n".join(lines) + "\n")
    return path


def vibration(gear, belt, seed):
    return 1 + 2 * gear + 0.5 * belt + gear * belt + random.Random(seed).gauss(0, 0.05)


def data_set(folder, cells, units=2, cycles=3, header="file,unit,health_gear,health_belt,system_rms"):
    rows = []
    for gear, belt in cells:
        for unit in range(units):
            for cycle in range(cycles):
                seed = hash((gear, belt, unit, cycle))
                name = f"r/{gear}_{belt}_{unit}_{cycle}.csv"
                write(folder / name, signals(gear, belt, seed))
                rows.append(f"{name},g{gear}b{belt}u{unit},{gear},{belt},{vibration(gear, belt, seed):.6f}")
    random.Random(1).shuffle(rows)
    (folder / "labels.csv").write_text("\n".join([header, *rows]) + "\n")
    return folder


CELLS = [(gear, belt) for gear in LEVELS for belt in LEVELS if (gear, belt) != (1.0, 1.0)]


class Health(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        data_set(FOLDER / "set", CELLS)
        (FOLDER / "set" / "failed_conditions.csv").write_text("unit,health_gear,health_belt\nx,1,1\n")
        code, out, error = run("health", "train", FOLDER / "set", "--out", FOLDER / "model", "--json")
        assert code == 0, error
        cls.report = json.loads(out)

    def refusal(self, *arguments):
        code, out, error = run("health", *arguments)
        self.assertEqual((code, out), (2, ""), error)
        return error.strip().replace(str(FOLDER) + "/", "")

    def train_refusal(self, folder, *more):
        refusal = self.refusal("train", folder, "--out", FOLDER / "none", *more)
        self.assertFalse((FOLDER / "none").exists())
        return refusal

    def test_the_report_has_the_keys_of_the_contract(self):
        report = self.report
        self.assertEqual(report["components"], ["gear", "belt"])
        self.assertEqual(set(report["selected"]), {"gear", "belt"})
        for name in report["components"]:
            self.assertTrue(report["selected"][name])
            self.assertEqual(set(report["rmse"][name]), {"random", "condition_left_out", "unit_left_out"})
            self.assertLess(report["rmse"][name]["unit_left_out"], 0.15)
        self.assertTrue(all(feature.startswith("current_A.") for feature in report["selected"]["gear"]))
        self.assertGreaterEqual(report["hidden_nodes"], 1)
        self.assertEqual([row["source"] for row in report["anova"]], ["gear", "belt", "gear:belt", "error", "total"])
        self.assertEqual({"source", "ss", "df", "f", "p"} - set(report["anova"][0]), set())
        self.assertEqual({"length", "signal_variance", "noise_variance", "log_likelihood"} - set(report["gpr"]), set())
        self.assertEqual(len(report["gpr"]["length"]), 2)
        self.assertEqual(report["failed_conditions"], [[1, 1]])
        self.assertEqual(len(report["bands"]), 8)

    def test_the_honest_splits_come_before_the_random_one(self):
        self.assertEqual([split["split"] for split in self.report["splits"]],
                         ["condition_left_out", "unit_left_out", "random"])
        for split in self.report["splits"]:
            self.assertLess(split["rmse"]["gear"], split["mean_rmse"]["gear"])

    def test_same_seed_same_bytes(self):
        code, out, error = run("health", "train", FOLDER / "set", "--out", FOLDER / "again", "--json")
        self.assertEqual(code, 0, error)
        self.assertEqual(json.loads(out), self.report)
        for name in ("health.json", "predictor.json"):
            self.assertEqual((FOLDER / "again" / name).read_bytes(), (FOLDER / "model" / name).read_bytes())

    def test_assess_tells_an_unseen_record(self):
        path = write(FOLDER / "new.csv", signals(0.5, 0.0, 991))
        code, out, error = run("health", "assess", FOLDER / "model", path, "--json")
        self.assertEqual(code, 0, error)
        (told,) = json.loads(out)
        self.assertEqual(told["file"], str(path))
        self.assertAlmostEqual(told["health"]["gear"]["value"], 0.5, delta=0.2)
        self.assertAlmostEqual(told["health"]["belt"]["value"], 0.0, delta=0.2)
        for bounded in (*told["health"].values(), told["system"]):
            self.assertLessEqual(bounded["low"], bounded["value"])
            self.assertLessEqual(bounded["value"], bounded["high"])
        # From 1 as new to 3 at the worst that was measured: 2 is the half of the way.
        self.assertAlmostEqual(told["system"]["value"], 1.0 / 2.0, delta=0.2)
        self.assertFalse(told["outside_training"])

    def test_assess_takes_folders_and_records_of_several_cycles(self):
        one = signals(1.0, 0.5, 5, rows=4 * ROWS)
        path = write(FOLDER / "long" / "long.csv", one)
        code, out, error = run("health", "assess", FOLDER / "model", path.parent, "--json")
        self.assertEqual(code, 0, error)
        (told,) = json.loads(out)
        self.assertGreaterEqual(told["cycles"], 3)
        self.assertAlmostEqual(told["health"]["gear"]["value"], 1.0, delta=0.25)
        code, out, _ = run("health", "assess", FOLDER / "model", FOLDER / "set", "--json")
        self.assertEqual(len(json.loads(out)), 3 * 2 * len(CELLS))

    def test_what_is_unlike_the_training_is_said(self):
        odd = signals(0.0, 0.0, 4)
        odd["current_A"] = [30 * value for value in odd["current_A"]]
        code, out, error = run("health", "assess", FOLDER / "model", write(FOLDER / "odd.csv", odd))
        self.assertEqual(code, 0, error)
        self.assertIn("outside what was trained on", out)

    def test_whatif_gives_shares_that_sum_to_the_system(self):
        code, out, error = run("health", "whatif", FOLDER / "model", "--state", "belt=0.5", "gear=1", "--json")
        self.assertEqual(code, 0, error)
        told = json.loads(out)
        shares = told["shares"]
        self.assertAlmostEqual(sum(shares["shapley"].values()) + shares["baseline"], told["system"], delta=1e-9)
        self.assertAlmostEqual(sum(shares["alone"].values()) + shares["interaction"] + shares["baseline"],
                               told["system"], delta=1e-9)
        self.assertEqual(told["ranking"], ["gear", "belt"])
        self.assertEqual(told["ties"], [])
        # v = 1 + 2 g + b / 2 + g b at (1, 1/2): 3.75; as new 1, the worst measured 3.75.
        self.assertAlmostEqual(told["system"], 1.0, delta=0.1)
        self.assertAlmostEqual(told["restored"]["gear"]["value"], 0.25 / 2.75, delta=0.1)
        self.assertFalse(told["extrapolated"])
        code, out, _ = run("health", "whatif", FOLDER / "model", "--state", "gear=1", "belt=1")
        self.assertIn("extrapolated", out)
        self.assertIn("nearer to a condition in which the system failed", out)

    def test_a_state_that_is_none_is_refused(self):
        model = FOLDER / "model"
        expected = "(expected each of gear=0…1 belt=0…1)"
        self.assertEqual(self.refusal("whatif", model, "--state", "gear=1"),
                         f"--state: error: belt is missing {expected}")
        self.assertEqual(self.refusal("whatif", model, "--state", "gear=1.5", "belt=0"),
                         f"--state: error: 'gear=1.5' has no number from 0 to 1 {expected}")
        self.assertEqual(self.refusal("whatif", model, "--state", "arm=1", "belt=0"),
                         f"--state: error: there is no component in 'arm=1' {expected}")
        self.assertEqual(self.refusal("whatif", model, "--state", "gear=1", "gear=0", "belt=0"),
                         f"--state: error: gear is there twice {expected}")

    def test_records_that_do_not_fit_are_refused(self):
        fast = write(FOLDER / "fast.csv", signals(0, 0, 1), sample_rate_hz=1000)
        self.assertEqual(self.refusal("assess", FOLDER / "model", fast),
                         "fast.csv: error: the sampling rate is 1000 Hz (expected 500 Hz, as in training)")
        dead = signals(0, 0, 1)
        dead["current_A"] = [0.0] * ROWS
        self.assertEqual(self.refusal("assess", FOLDER / "model", write(FOLDER / "dead.csv", dead)),
                         "dead.csv: error: current_A is 0 throughout (expected a signal: is the sensor connected?)")
        other = write(FOLDER / "other.csv", {"accel_x_m_per_s2": signals(0, 0, 1)["current_A"]}, kind="vibration")
        self.assertEqual(self.refusal("assess", FOLDER / "model", other),
                         "other.csv: error: kind is vibration (expected motor)")
        short = write(FOLDER / "short.csv", signals(0, 0, 1, rows=20))
        self.assertEqual(self.refusal("assess", FOLDER / "model", short),
                         "short.csv: error: a cycle has 20 rows (expected 32 or more)")

    def test_a_rate_that_nobody_tells_is_assumed_with_a_warning(self):
        folder = data_set(FOLDER / "no_rate", [(0, 0), (1, 0), (0, 1), (1, 1)], units=1)
        for path in (folder / "r").iterdir():
            path.write_text(path.read_text().replace(f"# sample_rate_hz: {RATE_HZ}\n", ""))
        code, out, error = run("health", "train", folder, "--out", FOLDER / "assumed", "--json", "--epochs", 20)
        self.assertEqual(code, 0, error)
        self.assertEqual(error.count("neither time_s nor sample_rate_hz is there; 1000 Hz is assumed"), 1)
        self.assertEqual(json.loads(out)["sample_rate_hz"], 1000)
        self.assertIn("each condition was recorded on one unit alone", " ".join(json.loads(out)["notes"]))

    def labels(self, name, change):
        folder = FOLDER / name
        data_set(folder, [(0, 0), (1, 0), (0, 1), (1, 1)], units=1)
        lines = (folder / "labels.csv").read_text().splitlines()
        (folder / "labels.csv").write_text("\n".join(change(lines)) + "\n")
        return folder

    def test_labels_that_teach_nothing_are_refused(self):
        def values(gear, belt):
            return lambda lines: [lines[0]] + [",".join([*line.split(",")[:2], gear(line), belt(line), "1"])
                                               for line in lines[1:]]
        folder = self.labels("one_condition", values(lambda line: "0.5", lambda line: "0"))
        self.assertRegex(self.train_refusal(folder),
                         r"^one_condition/labels.csv:2:\d+: error: health_gear is 0.5 in every row \(expected two "
                         r"levels of each component or more\)$")
        folder = self.labels("together", values(lambda line: line.split(",")[2], lambda line: line.split(",")[2]))
        self.assertRegex(self.train_refusal(folder),
                         r"^together/labels.csv:2:\d+: error: health_gear, health_belt change together: the data can "
                         r"tell 1 of 2 components apart \(expected conditions in which each changes by itself\)$")
        folder = self.labels("range", values(lambda line: "1.5", lambda line: "0"))
        self.assertRegex(self.train_refusal(folder), r"^range/labels.csv:2:\d+: error: health_gear is '1.5' \(expected "
                                                     r"a number from 0 to 1\)$")
        folder = self.labels("no_column", lambda lines: [lines[0].replace("health_", "h_")] + lines[1:])
        self.assertEqual(self.train_refusal(folder), "no_column/labels.csv:1:1: error: there is no column health_NAME "
                                                     "(expected one a component, beside h_gear, h_belt, system_rms)")
        folder = self.labels("bad_rms", lambda lines: [lines[0]] + [line.rsplit(",", 1)[0] + ",loud" for line in lines[1:]])
        self.assertRegex(self.train_refusal(folder), r"^bad_rms/labels.csv:2:\d+: error: system_rms is 'loud' "
                                                     r"\(expected a number from 0 up, or nothing where it was not measured\)$")
        folder = self.labels("gone", lambda lines: lines + ["r/none.csv,u,0,0,1"])
        self.assertRegex(self.train_refusal(folder), r"^gone/labels.csv:14:1: error: 'r/none.csv' names no file ")
        folder = self.labels("mixed", lambda lines: lines)
        first = (folder / "labels.csv").read_text().splitlines()[1].split(",")[0]
        last = (folder / "labels.csv").read_text().splitlines()[-1].split(",")[0]
        write(folder / last, signals(0, 0, 1), sample_rate_hz=250)
        self.assertEqual(self.train_refusal(folder), f"mixed/{last}: error: the sampling rate is 250 Hz (expected "
                                                     f"500 Hz, as in {first})")

    def test_records_that_are_all_the_same_are_refused(self):
        folder = self.labels("same", lambda lines: lines)
        for path in (folder / "r").iterdir():
            write(path, signals(0, 0, 1))
        self.assertEqual(self.train_refusal(folder),
                         "error: none of 224 features changes with the health of any component (expected records that "
                         "differ)")

    def test_without_system_rms_components_alone_are_told(self):
        folder = self.labels("no_system", lambda lines: [line.rsplit(",", 1)[0] for line in lines])
        code, out, error = run("health", "train", folder, "--out", FOLDER / "parts", "--json", "--epochs", 50)
        self.assertEqual(code, 0, error)
        report = json.loads(out)
        self.assertEqual((report["anova"], report["gpr"]), ([], None))
        code, out, _ = run("health", "assess", FOLDER / "parts", FOLDER / "new_for_parts.csv", "--json")
        self.assertEqual(code, 2)
        self.assertEqual(self.refusal("whatif", FOLDER / "parts", "--state", "gear=1", "belt=0"),
                         "parts: error: the model knows nothing of the system (expected one that was trained with "
                         "system_rms)")

    def test_a_model_that_was_changed_is_refused(self):
        text = (FOLDER / "model" / "health.json").read_text()
        copy = FOLDER / "changed"
        copy.mkdir()
        for name in ("predictor.json", "numbers.h5"):
            (copy / name).write_bytes((FOLDER / "model" / name).read_bytes())
        (copy / "health.json").write_text(text.replace('"limit_is": "the', '"limit_is": "The', 1))
        self.assertEqual(self.refusal("whatif", copy, "--state", "gear=1", "belt=0"),
                         "changed/health.json: error: the file has changed since it was written (expected the SHA-256 "
                         "that it has of itself)")
        self.assertEqual(self.refusal("whatif", FOLDER / "set", "--state", "gear=1", "belt=0"),
                         "set/health.json: error: cannot be read (expected a model, as `strainwave health train` writes "
                         "it)")

    def test_it_exports_as_predictors_do(self):
        code, out, error = run("export", FOLDER / "model", "--out", FOLDER / "exported")
        self.assertEqual(code, 0, error)
        recipe = json.loads((FOLDER / "exported" / "recipe.json").read_text())
        self.assertEqual((recipe["recipe"]["set"], recipe["outputs"]), ("packets", ["gear", "belt"]))
        self.assertTrue((FOLDER / "exported" / "model_card.md").exists())

    def test_a_monitor_runs_the_export_on_each_cycle_of_a_record(self):
        code, _, error = run("export", FOLDER / "model", "--out", FOLDER / "monitored")
        self.assertEqual(code, 0, error)
        path = write(FOLDER / "cycles.csv", signals(0.5, 0.5, 17, rows=4 * ROWS))
        code, out, error = run("health", "assess", FOLDER / "model", path, "--json")
        self.assertEqual(code, 0, error)
        (told,) = json.loads(out)
        code, out, error = run("monitor", FOLDER / "monitored", "--replay", path, "--pace", "max", "--json")
        self.assertEqual(code, 0, error)
        windows = [json.loads(line) for line in out.splitlines()]
        self.assertEqual(len(windows), told["cycles"])
        for name in ("gear", "belt"):
            mean = sum(window["values"][name]["value"] for window in windows) / len(windows)
            self.assertAlmostEqual(mean, told["health"][name]["value"], delta=1e-4)
        loop = FOLDER / "loop.csv"
        loop.write_text("# kind: hysteresis\ntime_s,torque_Nm,output_angle_deg\n0,0,0\n1,1,0.1\n2,0,0\n")
        code, out, error = run("monitor", FOLDER / "monitored", "--replay", loop, "--pace", "max")
        self.assertEqual((code, out), (2, ""))
        self.assertIn(f"{loop}: error: kind is hysteresis (expected motor)\n", error)


class Study(unittest.TestCase):
    def test_wafer_robot_is_a_data_set_that_health_learns_from(self):
        out = FOLDER / "robots"
        code, text, error = run("simulate", "--study", "wafer_robot", "--out", out, "--units", 1, "--seed", 4, "--json")
        self.assertEqual(code, 0, error)
        made = json.loads(text)
        self.assertEqual((made["files"], made["units"]), (275, 11))
        with (out / "labels.csv").open() as file:
            rows = list(csv.DictReader(file))
        conditions = {(row["health_hd"], row["health_tb"]) for row in rows}
        self.assertEqual(len(conditions), 11)
        self.assertEqual(sum(row["system_rms"] != "" for row in rows), 55)
        self.assertEqual((out / "failed_conditions.csv").read_text().splitlines()[1].split(",")[1:], ["1", "1"])
        code, text, error = run("health", "train", out, "--out", FOLDER / "robot_model", "--json", "--hidden-nodes", 8,
                                "--epochs", 100)
        self.assertEqual(code, 0, error)
        report = json.loads(text)
        self.assertEqual(report["failed_conditions"], [[1, 1]])
        self.assertEqual([row["df"] for row in report["anova"]], [2, 3, 5, 44, 54])
        self.assertLess(report["rmse"]["hd"]["random"], report["rmse"]["hd"]["condition_left_out"])


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    with tempfile.TemporaryDirectory() as folder:
        FOLDER = pathlib.Path(folder)
        unittest.main()
