#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave faults train` and `classify`, and the data set of `simulate --study joint_bearing`.

usage: faults_command_test.py PROGRAM     exit code 77: skipped, there is no NumPy"""
import hashlib
import json
import math
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
RATE_HZ, SAMPLES = 800, 1024
CLASSES = ("sound", "cracked", "worn")
QUICK = ("--epochs", 60)


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def signal(seed, tones, samples=SAMPLES, gain=1.0):
    """Tones (Hz and height) in noise."""
    random = numpy.random.default_rng(seed)
    time_s = numpy.arange(samples) / RATE_HZ
    values = 0.3 * random.standard_normal(samples)
    for frequency_hz, height in tones:
        values = values + height * numpy.sin(2 * numpy.pi * frequency_hz * time_s + random.uniform(0, 6))
    return gain * values


def write(path, columns, **metadata):
    path.parent.mkdir(parents=True, exist_ok=True)
    metadata = {"kind": "vibration", "sample_rate_hz": RATE_HZ} | metadata
    lines = [f"# {key}: {value}" for key, value in metadata.items() if value is not None] + [",".join(columns)]
    lines += [",".join(f"{value:.6g}" for value in row) for row in zip(*columns.values(), strict=True)]
    path.write_text("\n".join(lines) + "\n")
    return path


def tones(name):
    return {"sound": [], "cracked": [(150, 0.8)], "worn": [(40, 0.8)], "both": [(150, 0.8), (40, 0.8)]}[name]


def record(path, seed, name, gain=1.0, samples=SAMPLES, **metadata):
    return write(path, {"spindle_g": signal(seed, tones(name), samples, gain),
                        "table_g": signal(1000 + seed, tones(name)[:1], samples, gain)}, **metadata)


def data_set(folder, labels="class,load", names=CLASSES, units=3, records=3, row=None):
    """A folder with units of each class; rows of labels.csv in an order of their own."""
    row = row or (lambda name, unit, r: f"{name},{(10, 20, 40)[r % 3]}")
    rows = []
    for c, name in enumerate(names):
        for unit in range(units):
            gain = 1 + 0.1 * math.sin(5 * c + 3 * unit)
            for r in range(records):
                seed = 100 * c + 10 * unit + r
                record(folder / "data" / f"{name}_{unit}_{r}.csv", seed, name, gain)
                rows.append(f"data/{name}_{unit}_{r}.csv,{name[0]}{unit},{row(name, unit, r)}")
    numpy.random.default_rng(4).shuffle(rows)
    (folder / "labels.csv").write_text("\n".join([f"file,unit,{labels}", *rows]) + "\n")
    return folder


class Faults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = data_set(FOLDER / "set")
        code, out, error = run("faults", "train", cls.folder, "--out", FOLDER / "model", "--split", "load", "--json",
                               *QUICK)
        assert code == 0, error
        cls.report = json.loads(out)

    def refusal(self, *arguments):
        code, out, error = run(*arguments)
        self.assertEqual((code, out), (2, ""), error)
        return error.strip().replace(str(FOLDER) + "/", "")

    def train_refusal(self, folder, *arguments):
        refusal = self.refusal("faults", "train", folder, "--out", FOLDER / "none", *arguments)
        self.assertFalse((FOLDER / "none").exists())
        return refusal

    def labelled(self, name, text):
        """The records of the set under another table."""
        folder = FOLDER / name
        folder.mkdir()
        (folder / "data").symlink_to(self.folder / "data")
        (folder / "labels.csv").write_text(text)
        return folder

    def test_the_report_has_what_the_contract_asks_for(self):
        self.assertEqual(self.report["classes"], sorted(CLASSES))
        self.assertEqual(list(self.report["accuracy"]), ["random", "unit_left_out", "load"])
        for split, accuracy in self.report["accuracy"].items():
            self.assertGreater(accuracy, 0.9, split)
            confusion = self.report["confusion"][split]
            counts = [count for row in confusion.values() for count in row.values()]
            right = sum(confusion[name][name] for name in CLASSES)
            self.assertEqual(sum(counts), 27)
            self.assertAlmostEqual(accuracy, right / 27)
        self.assertEqual(self.report["channels"], ["spindle_g", "table_g"])

    def test_levels_are_as_many_as_the_shortest_record_allows(self):
        self.assertEqual(self.report["levels"], 6)
        self.assertEqual(self.report["bands"][0], {"level": 1, "low_hz": 200.0, "high_hz": 400.0})
        self.assertIn("details of 6 levels in place of 8: no more of sym8 fit into the 1024 samples of ",
                      self.report["notes"][0])

    def test_records_that_were_not_seen_are_classified(self):
        paths = [record(FOLDER / "new" / f"{name}.csv", 900 + k, name) for k, name in enumerate(CLASSES)]
        code, out, error = run("faults", "classify", FOLDER / "model", *paths, "--json")
        self.assertEqual(code, 0, error)
        verdicts = json.loads(out)
        self.assertEqual([verdict["class"] for verdict in verdicts], list(CLASSES))
        for path, verdict in zip(paths, verdicts, strict=True):
            self.assertEqual(verdict["file"], str(path))
            self.assertEqual(sorted(verdict["probabilities"]), sorted(CLASSES))
            self.assertAlmostEqual(sum(verdict["probabilities"].values()), 1.0, places=9)
            self.assertFalse(verdict["undecided"], verdict)
        code, out, error = run("faults", "classify", FOLDER / "model", FOLDER / "new")
        self.assertEqual(code, 0, error)
        self.assertIn(f"{paths[1]}: cracked\n", out)
        self.assertIn("3 records, 0 undecided", out)

    def test_one_record_is_an_array_too(self):
        path = record(FOLDER / "one.csv", 950, "worn")
        self.assertEqual(len(json.loads(run("faults", "classify", FOLDER / "model", path, "--json")[1])), 1)

    def test_what_lies_outside_the_training_is_undecided(self):
        path = write(FOLDER / "odd.csv", {"spindle_g": signal(1, [(300, 200.0)]), "table_g": signal(2, [(5, 90.0)])})
        verdict = json.loads(run("faults", "classify", FOLDER / "model", path, "--json")[1])[0]
        self.assertTrue(verdict["undecided"])
        self.assertRegex(verdict["why"], "^it lies outside what was trained on, by ")

    def test_the_rule_of_undecided_is_an_option(self):
        out = run("faults", "train", self.folder, "--out", FOLDER / "strict", "--undecided-below", 1, "--json",
                  *QUICK)[1]
        self.assertEqual(json.loads(out)["undecided_rule"],
                         {"least_probability": 1.0, "least_margin": 0.1, "outside_training_above": 1.0})
        self.assertGreater(json.loads(out)["splits"]["random"]["undecided"], 0.5)

    def test_same_seed_same_bytes(self):
        files = ("predictor.json", "numbers.h5", "faults.json")
        hashes = []
        for _ in range(2):
            code, _, error = run("faults", "train", self.folder, "--out", FOLDER / "again", "--epochs", 5)
            self.assertEqual(code, 0, error)
            hashes.append([hashlib.sha256((FOLDER / "again" / name).read_bytes()).hexdigest() for name in files])
        self.assertEqual(*hashes)

    def test_a_model_is_a_predictor_that_can_be_exported(self):
        code, _, error = run("export", FOLDER / "model", "--out", FOLDER / "exported")
        self.assertEqual(code, 0, error)
        recipe = json.loads((FOLDER / "exported" / "recipe.json").read_text())
        self.assertEqual((recipe["predicts"], recipe["outputs"]), ("classes", sorted(CLASSES)))
        path = record(FOLDER / "streamed.csv", 960, "cracked")
        code, out, error = run("monitor", FOLDER / "exported", "--replay", path, "--pace", "max", "--json")
        self.assertEqual(code, 0, error)
        told = json.loads(out.splitlines()[0])
        verdict = json.loads(run("faults", "classify", FOLDER / "model", path, "--json")[1])[0]
        self.assertEqual((told["class"], told["status"]), ("cracked", "good"))
        for name, probability in verdict["probabilities"].items():
            self.assertAlmostEqual(told["probabilities"][name], probability, delta=1e-4)

    def test_a_model_that_was_changed_is_refused(self):
        run("faults", "train", self.folder, "--out", FOLDER / "bent", "--epochs", 5)
        path = FOLDER / "bent" / "faults.json"
        path.write_text(path.read_text().replace('"least_margin": 0.1', '"least_margin": 0.2'))
        self.assertEqual(self.refusal("faults", "classify", FOLDER / "bent", self.folder / "data" / "worn_0_0.csv"),
                         "bent/faults.json: error: the file has changed since it was written (expected the SHA-256 "
                         "that it has of itself)")
        self.assertEqual(self.refusal("faults", "classify", FOLDER / "nothing", "x.csv"),
                         "nothing/faults.json: error: cannot be read (expected a model, as `strainwave faults train` "
                         "writes it)")

    def test_several_faults_at_once_are_tested_on_pairs(self):
        folder = data_set(FOLDER / "labels", "fault_crack,fault_wear", ("sound", "cracked", "worn", "both"), 3, 3,
                          lambda name, unit, r: f"{int(name in ('cracked', 'both'))},{int(name in ('worn', 'both'))}")
        code, out, error = run("faults", "train", folder, "--out", FOLDER / "several", "--json", *QUICK)
        self.assertEqual(code, 0, error)
        report = json.loads(out)
        self.assertEqual(report["classes"], ["crack", "wear"])
        self.assertEqual(list(report["accuracy"]), ["random", "unit_left_out", "pairs_left_out"])
        self.assertGreater(report["accuracy"]["unit_left_out"], 0.9)
        counts = report["confusion"]["unit_left_out"]["crack"]
        self.assertEqual(sum(counts[key] for key in ("present_told", "absent_told", "present_missed",
                                                     "absent_not_told")), 36)
        code, _, error = run("export", FOLDER / "several", "--out", FOLDER / "exported_several")
        self.assertEqual(code, 0, error)
        path = record(FOLDER / "both.csv", 990, "both")
        verdict = json.loads(run("faults", "classify", FOLDER / "several", path, "--json")[1])[0]
        self.assertEqual((verdict["class"], verdict["faults"]), ("crack+wear", ["crack", "wear"]))
        path = record(FOLDER / "neither.csv", 991, "sound")
        verdict = json.loads(run("faults", "classify", FOLDER / "several", path, "--json")[1])[0]
        self.assertEqual((verdict["class"], verdict["faults"]), ("none", []))

    def test_rows_can_be_chosen(self):
        out = run("faults", "train", self.folder, "--out", FOLDER / "some", "--where", "class=sound,worn", "--where",
                  "load=10,20", "--epochs", 5, "--json")[1]
        report = json.loads(out)
        self.assertEqual((report["classes"], report["records"]), (["sound", "worn"], 12))
        self.assertEqual(self.train_refusal(self.folder, "--where", "class=new"),
                         "set/labels.csv: error: no row passes --where (expected values that stand in its columns)")
        self.assertEqual(self.train_refusal(self.folder, "--where", "class"),
                         "--where: error: 'class' (expected COLUMN=VALUE or COLUMN=VALUE,VALUE)")

    def test_orders_of_the_envelope_stand_beside_where_the_speed_is_known(self):
        folder, rows = FOLDER / "turning", []
        rate_hz, bearing = 8000, (9, 7.94, 39.04)
        for c, order in enumerate((None, 3.5848, 5.4152)):
            for rpm in (600, 900, 1200):
                for k in range(3):
                    random = numpy.random.default_rng(100 * c + rpm + k)
                    turns = numpy.arange(12 * rate_hz * 60 // rpm) / (rate_hz * 60 / rpm)
                    swing = 1 if order is None else 1 + 0.8 * numpy.cos(2 * numpy.pi * order * turns)
                    # How loud it is depends on the speed and says nothing.
                    values = rpm / 600 * swing * random.standard_normal(len(turns))
                    write(folder / f"{c}_{rpm}_{k}.csv", {"accel_x_m_per_s2": values}, sample_rate_hz=rate_hz,
                          input_speed_rpm=rpm)
                    rows.append(f"{c}_{rpm}_{k}.csv,bearing_{c},{('sound', 'outer', 'inner')[c]},{rpm}")
        (folder / "labels.csv").write_text("\n".join(["file,unit,class,rpm", *rows]) + "\n")
        code, out, error = run("faults", "train", folder, "--out", FOLDER / "turned", "--split", "rpm", "--json",
                               "--bearing", ",".join(map(str, bearing)), *QUICK)
        self.assertEqual(code, 0, error)
        report = json.loads(out)
        self.assertEqual(report["features"], "envelope_orders")
        self.assertGreater(report["compared"]["envelope_orders"]["accuracy"]["rpm"], 0.9)
        self.assertLess(report["compared"]["details"]["accuracy"]["rpm"], 0.7)
        # Each class one bearing: who left it out would have nothing to learn it from.
        self.assertIsNone(report["accuracy"]["unit_left_out"])
        self.assertIn("unit_left_out: each class stands in one unit alone: what is left out, nothing teaches",
                      report["limits"])
        verdict = json.loads(run("faults", "classify", FOLDER / "turned", folder / "1_900_0.csv", "--json")[1])[0]
        self.assertAlmostEqual(verdict["bearing"]["outer_race"]["order"], 3.5848, places=4)
        self.assertAlmostEqual(verdict["bearing"]["outer_race"]["frequency_hz"], 3.5848 * 15, places=2)
        self.assertGreater(verdict["bearing"]["outer_race"]["prominence_db"],
                           verdict["bearing"]["inner_race"]["prominence_db"] + 3)
        still = write(FOLDER / "still.csv", {"accel_x_m_per_s2": signal(1, [], 3000)}, sample_rate_hz=rate_hz)
        self.assertEqual(self.refusal("faults", "classify", FOLDER / "turned", still),
                         "still.csv: error: there is no steady speed of the input shaft (expected metadata or column "
                         "input_speed_rpm, or column input_speed_rad_per_s)")
        code, _, error = run("faults", "classify", FOLDER / "turned", still, "--input-speed", 900)
        self.assertEqual(code, 0, error)

    def test_labels_that_teach_nothing_are_refused(self):
        head, *rows = (self.folder / "labels.csv").read_text().splitlines()
        one = self.labelled("alike", "\n".join([head, *[row for row in rows if "sound" in row]]))
        self.assertEqual(self.train_refusal(one),
                         "alike/labels.csv: error: class is 'sound' in every record (expected records of two classes "
                         "or more)")
        none = self.labelled("bare", "file,unit,load\n" + rows[0].replace("sound,", "").replace("worn,", "")
                             .replace("cracked,", ""))
        self.assertEqual(self.train_refusal(none),
                         "bare/labels.csv:1:1: error: there is no column class and no fault_NAME (expected what each "
                         "record shows in one of these)")
        empty = self.labelled("empty", "\n".join(["file,unit,class", "data/sound_0_0.csv,s0,sound",
                                                  "data/worn_0_0.csv,w0,"]))
        self.assertEqual(self.train_refusal(empty),
                         "empty/labels.csv:3:22: error: class is empty (expected the name of a class)")
        half = self.labelled("half", "\n".join(["file,unit,fault_wear", "data/sound_0_0.csv,s0,0",
                                                "data/worn_0_0.csv,w0,0.5"]))
        self.assertEqual(self.train_refusal(half),
                         "half/labels.csv:3:22: error: fault_wear is '0.5' (expected 0 or 1)")
        few = self.labelled("few", "\n".join(["file,unit,class", "data/sound_0_0.csv,s0,sound",
                                              "data/worn_0_0.csv,w0,worn"]))
        self.assertRegex(self.train_refusal(few),
                         r"^few/labels.csv: error: 2 records of 2 classes.* \(expected 4 records or more, of two "
                         r"classes or more\)$")
        self.assertEqual(self.train_refusal(self.folder, "--split", "mood"),
                         "set/labels.csv:1:1: error: column 'mood' is missing (expected it beside file, unit, class, "
                         "load)")
        self.assertEqual(self.train_refusal(self.folder, "--multi-label"),
                         "set/labels.csv:1:1: error: there is no column fault_NAME (expected a column of 0 and 1 for "
                         "each fault)")
        self.assertEqual(self.train_refusal(self.folder, "--features", "envelope_orders"),
                         "--features: error: envelope_orders (expected details: not every record tells a steady "
                         "speed)")
        self.assertEqual(self.train_refusal(self.folder, "--bearing", "9,40,30"),
                         "--bearing: error: element_diameter_m = 0.04 is not below pitch_diameter_m = 0.03 (expected "
                         "a bearing)")
        self.assertEqual(self.train_refusal(self.folder, "--bearing", "9,x"),
                         "--bearing: error: '9,x' (expected elements,element diameter in mm,pitch diameter in mm"
                         "[,contact angle in degrees])")

    def test_records_that_do_not_fit_are_refused_or_left_out_with_a_note(self):
        head, *rows = (self.folder / "labels.csv").read_text().splitlines()
        folder = self.labelled("mixed", "\n".join([head, *rows, "fast.csv,s0,sound,10"]))
        record(folder / "fast.csv", 5, "sound", sample_rate_hz=700)
        self.assertEqual(self.train_refusal(folder),
                         "mixed/fast.csv: error: the sampling rate is 700 Hz (expected 800 Hz or a multiple of it, as in "
                         "training)")
        record(folder / "fast.csv", 5, "sound", samples=20)
        self.assertEqual(self.train_refusal(folder),
                         "fast.csv: error: 20 samples: not one level of sym8 fits (expected 30 samples or more)")
        write(folder / "fast.csv", {"spindle_g": numpy.full(SAMPLES, 1.5), "table_g": signal(3, [])})
        code, out, error = run("faults", "train", folder, "--out", FOLDER / "left", "--epochs", 5, "--json")
        self.assertEqual(code, 0, error)
        report = json.loads(out)
        self.assertEqual(report["records"], 27)
        notes = [note.replace(str(FOLDER) + "/", "") for note in report["notes"]]
        self.assertIn("mixed/fast.csv: spindle_g is 1.5 throughout (expected a signal: is the sensor connected?); left "
                      "out", notes)
        write(folder / "fast.csv", {"table_g": signal(3, [])})
        self.assertRegex(self.train_refusal(folder), r"^mixed/fast.csv: error: there is no channel spindle_g ")
        code, out, _ = run("faults", "classify", FOLDER / "model", folder / "fast.csv")
        self.assertEqual((code, out), (2, ""))

    def test_a_unit_of_two_classes_is_told(self):
        head, *rows = (self.folder / "labels.csv").read_text().splitlines()
        folder = self.labelled("moved", "\n".join([head, *[row.replace(",w0,", ",s0,") for row in rows]]))
        code, out, error = run("faults", "train", folder, "--out", FOLDER / "moved_model", "--epochs", 5, "--json")
        self.assertEqual(code, 0, error)
        self.assertIn("unit s0 has records of more than one class: where a unit is left out, all of it is",
                      json.loads(out)["limits"])

    def test_the_line_of_the_study_and_other_wavelets(self):
        code, out, error = run("faults", "train", self.folder, "--out", FOLDER / "study", "--line", "study",
                               "--epochs", 3000, "--compare", "--json")
        self.assertEqual(code, 0, error)
        report = json.loads(out)
        self.assertEqual(report["line"], "study")
        self.assertGreater(report["accuracy"]["unit_left_out"], 0.8)
        self.assertEqual(list(report["accuracy_by_levels"]), [str(level) for level in range(1, 7)])
        self.assertIn("haar", report["accuracy_by_wavelet"])
        path = record(FOLDER / "by_study.csv", 970, "worn")
        verdict = json.loads(run("faults", "classify", FOLDER / "study", path, "--json")[1])[0]
        self.assertEqual(verdict["class"], "worn")
        code, _, error = run("export", FOLDER / "study", "--out", FOLDER / "exported_study")
        self.assertEqual(code, 0, error)

    def test_pictures_are_drawn_when_asked_for(self):
        with needed.peers("/usr/bin/gnuplot"):
            pass
        code, out, error = run("faults", "train", self.folder, "--out", FOLDER / "drawn", "--epochs", 5, "--plots",
                               FOLDER / "pictures")
        self.assertEqual(code, 0, error)
        names = {path.name for path in (FOLDER / "pictures").glob("*.svg")}
        self.assertEqual(names, {"confusion_random.svg", "confusion_unit_left_out.svg", "details.svg",
                                 "deviations.svg", "outputs.svg", "training.svg"})
        self.assertRegex(out, r"(?m)^  unit_left_out +27 ")


class Study(unittest.TestCase):
    def test_same_seed_same_bytes_and_labels_that_fit(self):
        folders = [FOLDER / "joint", FOLDER / "joint_again"]
        for folder in folders:
            code, out, error = run("simulate", "--study", "joint_bearing", "--units", 1, "--seed", 3, "--out", folder,
                                   "--json")
            self.assertEqual(code, 0, error)
        made = json.loads(out)
        self.assertEqual((made["files"], made["units"]), (112, 6))
        table = (folders[0] / "labels.csv").read_text()
        self.assertEqual(table, (folders[1] / "labels.csv").read_text())
        self.assertTrue(table.startswith("file,unit,class,fault_inner_race,fault_outer_race,faults,damage_mm,load_kg,"
                                         "speed_percent,anti_alias_filter\n"))
        self.assertEqual(len(re.findall(r",inner_race\+outer_race_[12]mm,1,1,2,", table)), 16)
        for name in ("0001.h5", "0112.h5"):
            bytes_of = [(folder / "records" / name).read_bytes() for folder in folders]
            self.assertEqual(*bytes_of)
        code, out, error = run("faults", "train", folders[0], "--out", FOLDER / "joint_model", "--where", "faults=0,1",
                               "--split", "speed_percent", "--json", *QUICK)
        self.assertEqual(code, 0, error)
        report = json.loads(out)
        self.assertEqual((report["levels"], report["records"], report["sample_rate_hz"]), (8, 96, 1031.0))
        self.assertGreater(report["accuracy"]["random"], 0.8)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    with tempfile.TemporaryDirectory() as folder:
        FOLDER = pathlib.Path(folder)
        unittest.main()
