#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A predictor under another load, at another speed, on a cold gear: told as outside, and what is not known is said.

usage: operating_range_test.py PROGRAM     exit code 77: skipped, there is no h5py or NumPy"""
import ctypes
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "peers"))
import exported_campaign  # noqa: E402
import needed  # noqa: E402

with needed.peers():
    import h5py
    import numpy

PROGRAM, FOLDER = "", pathlib.Path()
CHANNELS = ["accel_x_m_per_s2", "accel_y_m_per_s2", "accel_z_m_per_s2", "accel_motor_z_m_per_s2"]
NOT_SAID = ["output_torque_Nm is not known (trained at 40.6", "temperature_degC is not known (trained at 2"]


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


class OperatingRange(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.campaign, cls.exported = exported_campaign.make(PROGRAM, FOLDER)
        cls.record = cls.campaign / "cycles" / "000010.h5"
        with h5py.File(cls.record) as file:
            vibration = file["measurement_rotation/vibration"]
            cls.vibration = {channel: vibration[channel][:].astype(float) for channel in CHANNELS}
            cls.measured = {
                "output_torque_Nm": numpy.abs(file["measurement_rotation/rotation/output_torque_Nm"][:]).mean(),
                "temperature_degC": file["measurement_rotation/rotation/temperature_degC"][:].mean()}

    def write(self, name, **metadata):
        """The tenth cycle's vibration, and what the record says of the gear."""
        metadata = {"kind": "vibration", "sample_rate_hz": 25600, "input_speed_rpm": 2400} | metadata
        lines = [f"# {key}: {value}" for key, value in metadata.items()] + [",".join(CHANNELS)]
        lines += [",".join(map(repr, map(float, row))) for row in zip(*self.vibration.values(), strict=True)]
        (FOLDER / name).write_text("\n".join(lines) + "\n")
        return FOLDER / name

    def predict(self, *arguments):
        code, out, error = run("predict", FOLDER / "predictor", *arguments, "--json")
        self.assertEqual(code, 0, error)
        return json.loads(out), error

    def monitor(self, *arguments):
        code, out, error = run("monitor", self.exported, *arguments, "--pace", "max", "--json")
        self.assertEqual(code, 0, error)
        return [json.loads(line) for line in out.splitlines()], error

    def test_the_range_of_the_training_stands_in_recipe_model_and_card(self):
        of_training = json.loads((FOLDER / "predictor" / "predictor.json").read_text())["recipe"]["operating_envelope"]
        for name, measured in self.measured.items():
            least, greatest = of_training[name]
            self.assertLessEqual(least, measured)
            self.assertLessEqual(measured, greatest)
        self.assertEqual(of_training["input_speed_rpm"], [2400.0, 2400.0])
        self.assertEqual(json.loads((self.exported / "recipe.json").read_text())["recipe"]["operating_envelope"],
                         of_training)
        self.assertEqual(json.loads((self.exported / "model_card.json").read_text())["operating_envelope"], of_training)
        self.assertIn("| input_speed_rpm | 2400 | 2400 |", (self.exported / "model_card.md").read_text())
        self.assertIn(json.dumps(of_training, separators=(",", ":")).encode(),
                      (self.exported / "model.onnx").read_bytes())

    def test_a_cycle_like_those_of_the_training_is_good(self):
        prediction, error = self.predict(self.record)
        self.assertFalse(prediction["outside_training"])
        self.assertEqual((prediction["outside"], prediction["warnings"]), ([], []))
        self.assertEqual(error, "")
        results, _ = self.monitor("--replay", self.record)
        self.assertEqual([result["status"] for result in results], ["good"])
        self.assertNotIn("warnings", results[0])

    def test_another_load_is_outside_although_it_sounds_the_same(self):
        path = self.write("light.csv", output_torque_Nm=12, temperature_degC=24)
        prediction, _ = self.predict(path)
        self.assertTrue(prediction["outside_training"])
        self.assertEqual(len(prediction["outside"]), 1)
        self.assertRegex(prediction["outside"][0], r"^output_torque_Nm is 12 \(trained at 40.6.*\)$")
        _, text, _ = run("predict", FOLDER / "predictor", path)
        self.assertRegex(text, r"^\S+: outside what the predictor was trained on \(output_torque_Nm is 12 \(trained "
                               r"at 40.6.*\)\): not valid\n")
        self.assertNotIn("±", text)
        results, _ = self.monitor("--replay", path)
        self.assertEqual([result["status"] for result in results], ["outside_training"])
        self.assertEqual(results[0]["outside"], prediction["outside"])

    def test_a_cold_gear_and_another_speed_are_outside(self):
        cold = self.write("cold.csv", output_torque_Nm=40.6, temperature_degC=3)
        self.assertRegex(self.predict(cold)[0]["outside"][0],
                         r"^temperature_degC is 3 \(trained at 2[\d.]+ to 2[\d.]+\)$")
        slow = self.write("slow.csv", output_torque_Nm=40.6, temperature_degC=24, input_speed_rpm=2000)
        self.assertEqual(self.predict(slow)[0]["outside"], ["input_speed_rpm is 2000 (trained at 2400)"])

    def test_what_a_record_does_not_say_is_said_once_and_may_be_given(self):
        path = self.write("silent.csv")
        predictions, error = self.predict(path, path)
        for prediction in predictions:
            self.assertFalse(prediction["outside_training"])
            for text, expected in zip(prediction["warnings"], NOT_SAID, strict=True):
                self.assertTrue(text.startswith(expected), text)
        self.assertEqual(error.count("warning: output_torque_Nm is not known"), 1)
        self.assertEqual(error.count("warning: temperature_degC is not known"), 1)
        results, error = self.monitor("--replay", path, path)
        self.assertEqual(["warnings" in result for result in results], [True, False])
        self.assertEqual(error.count("warning: output_torque_Nm is not known"), 1)
        given, error = self.predict(path, "--output-torque", 20, "--temperature", 24)
        self.assertRegex(given["outside"][0], r"^output_torque_Nm is 20 ")
        self.assertEqual((given["warnings"], error), ([], ""))
        results, error = self.monitor("--replay", path, "--output-torque", 40, "--temperature", 3)
        self.assertEqual(results[0]["status"], "outside_training")
        self.assertNotIn("not known", error)

    def test_an_option_that_contradicts_the_record_is_told_and_the_record_counts(self):
        path = self.write("said.csv", output_torque_Nm=40.6, temperature_degC=24)
        prediction, error = self.predict(path, "--output-torque", 5)
        self.assertFalse(prediction["outside_training"])
        self.assertEqual(prediction["warnings"], ["output_torque_Nm is 40.6 and was given as 5; 40.6 counts"])
        self.assertIn(prediction["warnings"][0], error)

    def test_the_simulated_bench_under_another_load_is_never_good(self):
        for torque_Nm, expected in ((40, False), (20, True), (5, True)):
            results, _ = self.monitor("--simulate", "--output-torque", torque_Nm, "--duration", 5)
            self.assertEqual(len(results), 2)
            for result in results:
                reasons = result.get("outside", [])
                self.assertEqual(any(text.startswith("output_torque_Nm is ") for text in reasons), expected)
                self.assertTrue(result["status"] == "outside_training" or not expected)

    def test_a_program_in_c_says_under_what_the_gear_runs(self):
        library = ctypes.CDLL(str(pathlib.Path(PROGRAM).parent / "libstrainwave_predictor.so"))
        library.strainwave_predictor_open.restype = ctypes.c_void_p
        error = ctypes.create_string_buffer(400)
        predictor = ctypes.c_void_p(library.strainwave_predictor_open(str(self.exported).encode(), error, 400))
        self.assertTrue(predictor.value, error.value)
        samples = [numpy.ascontiguousarray(self.vibration[name]) for name in CHANNELS]
        pointer = ctypes.POINTER(ctypes.c_double)
        channels = (pointer * len(samples))(*(each.ctypes.data_as(pointer) for each in samples))
        values = (ctypes.c_double * 15)()

        def status():
            return library.strainwave_predictor_run(predictor, channels, ctypes.c_size_t(len(samples[0])),
                                                    ctypes.c_double(25600.0), values, None, error, ctypes.c_size_t(400))

        self.assertEqual(status(), 0)
        of = [ctypes.c_double(value) for value in (12.0, float("nan"), 24.0)]
        library.strainwave_predictor_set_operating_point(predictor, *of)
        self.assertEqual(status(), 1)
        self.assertRegex(error.value.decode(), r"^the window lies outside what the predictor was trained on: "
                                               r"output_torque_Nm is 12 \(trained at 40.6.*\)$")
        library.strainwave_predictor_close(predictor)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    with tempfile.TemporaryDirectory() as folder:
        FOLDER = pathlib.Path(folder)
        unittest.main()
