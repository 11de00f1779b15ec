#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave train` where nothing, or the wrong thing, can be learnt: columns of time, snapshots of one specimen, a
network that is worth nothing.

usage: honest_training_test.py PROGRAM     exit code 77: skipped, there is no NumPy"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "peers"))
import needed  # noqa: E402

with needed.peers():
    import numpy

PROGRAM, FOLDER = "", pathlib.Path()
RATE_HZ, SAMPLES = 8192, 16384


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr.replace(str(FOLDER) + "/", "")


def write(path, columns, **metadata):
    path.parent.mkdir(parents=True, exist_ok=True)
    metadata = {"kind": "vibration", "sample_rate_hz": RATE_HZ} | metadata
    lines = [f"# {key}: {value}" for key, value in metadata.items()] + [",".join(columns)]
    lines += [",".join(f"{value:.8g}" for value in row) for row in zip(*columns.values(), strict=True)]
    path.write_text("\n".join(lines) + "\n")
    return path


def noise_records(name, beside):
    """Eight records of noise, four a class, one after the other; `beside`: a second column, its name and values."""
    for number in range(8):
        noise = numpy.random.default_rng(40 + number).standard_normal(SAMPLES)
        columns = {"accel_z_m_per_s2": noise}
        if beside is not None:
            columns = {beside[0]: beside[1](number)} | columns
        write(FOLDER / name / f"{number}.csv", columns, **{"class": "first" if number < 4 else "later"})
    return FOLDER / name


def train(folder, *arguments):
    code, out, error = run("train", folder, "--out", FOLDER / "predictor", "--json", *arguments)
    assert code == 0, error
    return json.loads(out), error


def accuracy(report, split="unseen specimens", contestant="network"):
    found = next(each for each in report["splits"] if each["split"] == split)
    return found["scores"][contestant]["accuracy_percent"]


class HonestTraining(unittest.TestCase):
    def test_columns_of_time_index_and_label_are_no_channels(self):
        index = numpy.arange(SAMPLES)
        control = train(noise_records("control", None))[0]["splits"]
        beside = {"Clock": lambda number: (index + number * SAMPLES) / RATE_HZ,
                  "logger_V": lambda number: 100.0 + index + number * SAMPLES,
                  "Sample No": lambda number: index + number * SAMPLES,
                  "Label": lambda number: numpy.full(SAMPLES, float(number > 3))}
        for name, column in beside.items():
            report, error = train(noise_records(f"with {name}", (name, column)))
            self.assertEqual(report["splits"], control, name)
            told = [text for text in report["warnings"] if f"the column {name} is left out" in text]
            self.assertEqual(len(told), 1, report["warnings"])
            self.assertTrue(told[0].endswith("; so in 8 of 8 records"), told)
            self.assertIn(f"with {name}/0.csv: warning: the column {name} is left out: ", error)
            recipe = json.loads((FOLDER / "predictor" / "predictor.json").read_text())["recipe"]
            self.assertEqual(recipe["channels"], ["accel_z_m_per_s2"])

    def test_such_a_column_is_refused_where_it_is_named(self):
        folder = noise_records("named", ("Clock", lambda number: numpy.arange(SAMPLES) / RATE_HZ))
        code, out, error = run("train", folder, "--channels", "Clock", "--out", FOLDER / "none")
        self.assertEqual((code, out), (2, ""))
        self.assertEqual(error, "named/0.csv: error: the column Clock is left out: the name stands for time, an index "
                                "or a label (expected the name and unit of a signal, such as accel_x_m_per_s2)\n")
        alone = write(FOLDER / "alone.csv", {"Clock": numpy.arange(SAMPLES)}, **{"class": "a"})
        for command in ("train", alone, "--out", FOLDER / "none"), ("diagnose", alone), ("features", alone):
            code, out, error = run(*command)
            self.assertEqual((code, out), (2, ""), command)
            self.assertIn("alone.csv: error: no column is a channel of vibration: the column Clock is left out", error)

    def test_a_diagnosis_does_not_see_the_ramp(self):
        random = numpy.random.default_rng(8)
        time_s = numpy.arange(8000) / 4000
        accel = random.standard_normal(8000) + 2 * numpy.sin(2 * numpy.pi * 25 * time_s)
        columns = {"Clock": 17.0 + time_s, "label": numpy.full(8000, 3.0), "accel_z_m_per_s2": accel}
        path = write(FOLDER / "ramp.csv", columns, sample_rate_hz=4000, input_speed_rpm=1500)
        code, out, error = run("diagnose", path, "--json")
        self.assertEqual(code, 0, error)
        diagnosis = json.loads(out)
        self.assertEqual(diagnosis["verdict"], "no_effect")
        self.assertNotIn("Clock", json.dumps(diagnosis["nominal"]))
        left_out = [text for text in diagnosis["warnings"] if "left out: the name stands for time" in text]
        self.assertEqual(len(left_out), 2, diagnosis["warnings"])

    def snapshots(self, name, folders, classes, **metadata):
        """Ten snapshots of each specimen; how loud it is tells it from the others and says nothing of its class."""
        for place, folder in enumerate(folders):
            for number in range(10):
                random = numpy.random.default_rng(1000 * place + number)
                said = {key: value(place) for key, value in metadata.items()}
                write(FOLDER / name / folder / f"{number}.csv",
                      {"accel_z_m_per_s2": 3.0 ** place * random.standard_normal(4096)},
                      **({"class": classes[place]} | said))
        return FOLDER / name

    def test_a_folder_of_snapshots_is_one_specimen(self):
        folders, classes = ("B1", "B2", "B3", "B4", "B5"), ("outer", "inner", "outer", "inner", "outer")
        report, error = train(self.snapshots("found", folders, classes))
        self.assertEqual(len({source["specimen"] for source in report["campaigns"]}), 5)
        self.assertIn("50 files in 5 folders name no specimen: each folder is taken for a specimen, 5 in all (expected "
                      "`# specimen: NAME` in the metadata of each, or --specimen-per file or folder)",
                      report["warnings"])
        self.assertIn("warning: 50 files in 5 folders name no specimen", error)
        named, _ = train(self.snapshots("named", folders, classes, specimen=lambda place: f"bearing {place}"))
        self.assertEqual([text for text in named["warnings"] if "specimen" in text], [])
        for report in report, named:
            # What holds for a specimen that was not seen leads; that it is known again is no proof.
            self.assertEqual([split["split"] for split in report["splits"]],
                             ["unseen specimens", "last part of each life", "random"])
            self.assertTrue(report["splits"][1]["meaning"].startswith("flatters: "))
            for contestant in "network", "forest", "ridge":
                self.assertLessEqual(accuracy(report, contestant=contestant), 60.0)
            self.assertFalse(report["worth"]["any"])
        self.assertEqual(named["splits"][0]["meaning"], "a reducer that was never seen; each left out in turn")
        self.assertEqual(named["splits"][0]["scores"], named["folds"]["scores"])

    def test_files_of_one_folder_are_specimens_with_a_warning(self):
        folder = self.snapshots("flat", ("all",), ("sound",))
        for number in range(10):
            path = folder / "all" / f"{number}.csv"
            path.write_text(path.read_text().replace("class: sound", f"class: {'ab'[number % 2]}"))
        report, _ = train(folder)
        self.assertIn("10 files in 1 folder name no specimen: each file is taken for a specimen, 10 in all; where "
                      "several are of one, what is told of unseen specimens flatters (expected `# specimen: NAME` in "
                      "the metadata of each, or --specimen-per file or folder)", report["warnings"])
        self.assertEqual(report["splits"][0]["meaning"],
                         "a reducer that was never seen, if each file is of another; each left out in turn")
        deep = self.snapshots("deep", ("x", "y"), ("a", "b"))
        self.assertEqual(len({each["specimen"] for each in train(deep)[0]["campaigns"]}), 2)
        by_file, _ = train(deep, "--specimen-per", "file")
        self.assertEqual(len({each["specimen"] for each in by_file["campaigns"]}), 20)

    def quantities(self, name, stiffness):
        for number in range(12):
            random = numpy.random.default_rng(70 + number)
            height = 0.5 + 0.1 * number
            tone = height * numpy.sin(2 * numpy.pi * 400 * numpy.arange(SAMPLES) / RATE_HZ)
            write(FOLDER / name / f"{number}.csv", {"accel_z_m_per_s2": tone + 0.2 * random.standard_normal(SAMPLES)},
                  k2_Nm_per_rad=stiffness(height, random), specimen=f"gear {number}")
        return FOLDER / name

    def test_a_network_worth_nothing_says_so_and_is_exported_only_when_insisted_on(self):
        nothing = self.quantities("nothing", lambda height, random: 30000 * (1 + 0.002 * random.standard_normal()))
        code, out, error = run("train", nothing, "--out", FOLDER / "worthless")
        self.assertEqual(code, 0, error)
        last = out.splitlines()[-1]
        self.assertRegex(last, r"^This network is worth nothing: on unseen specimens its error is [\d.]+ %, that of "
                               r"always saying the mean [\d.]+ %.*\.$")
        training = json.loads((FOLDER / "worthless" / "predictor.json").read_text())["training"]
        self.assertEqual((training["worth"]["any"], training["worth"]["sentence"]), (False, last))
        mean_percent = training["folds"]["scores"]["mean"]["mean_mape_percent"]
        self.assertAlmostEqual(training["worth"]["uses"][0]["same_error_percent"], mean_percent, delta=1e-9)
        code, out, error = run("export", FOLDER / "worthless", "--out", FOLDER / "exported")
        self.assertEqual((code, out), (2, ""))
        self.assertEqual(error, f"worthless: error: {last} Nothing was written (expected a predictor that is worth "
                                "something, or --anyway)\n")
        self.assertFalse((FOLDER / "exported").exists())
        code, _, error = run("export", FOLDER / "worthless", "--out", FOLDER / "exported", "--anyway")
        self.assertEqual(code, 0, error)
        self.assertIn(f"**{last}**", (FOLDER / "exported" / "model_card.md").read_text())

    def test_a_network_that_has_learnt_something_says_nothing(self):
        report, _ = train(self.quantities("something", lambda height, random: 30000 - 4000 * height))
        self.assertEqual((report["worth"]["any"], report["worth"]["sentence"]), (True, ""))
        code, _, error = run("export", FOLDER / "predictor", "--out", FOLDER / "useful")
        self.assertEqual(code, 0, error)
        self.assertNotIn("worth nothing", (FOLDER / "useful" / "model_card.md").read_text())


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    with tempfile.TemporaryDirectory() as folder:
        FOLDER = pathlib.Path(folder)
        unittest.main()
