#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave features` against PyWavelets and against plain NumPy, on records made afresh.

usage: features_command_test.py PROGRAM [--seed N]     exit code 77: skipped, there is no NumPy"""
import argparse
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "peers"))
import needed  # noqa: E402

with needed.peers():
    import numpy
try:
    import pywt
except ImportError:
    pywt = None

PROGRAM, SEED, FOLDER = "", 1, pathlib.Path()
GOLDEN = pathlib.Path(os.environ.get("STRAINWAVE_GOLDEN") or
                      pathlib.Path(__file__).resolve().parents[2] / "../shared/golden")


def run(*arguments):
    done = subprocess.run([PROGRAM, "features", *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def report(*arguments):
    code, out, error = run(*arguments, "--json")
    assert code == 0, error
    return json.loads(out)


def write(name, columns, **metadata):
    path = FOLDER / name
    lines = ["# kind: vibration"] + [f"# {key}: {value}" for key, value in metadata.items()]
    lines.append(",".join(columns))
    lines += [",".join(map(repr, map(float, row))) for row in zip(*columns.values(), strict=True)]
    path.write_text("\n".join(lines) + "\n")
    return path


def rows_of(name):
    with (GOLDEN / name).open() as file:
        return list(csv.DictReader(file))


def noise(n, *salt):
    random = numpy.random.default_rng([SEED, n, *salt])
    return numpy.sin(0.05 * numpy.arange(n)) + 0.5 * random.standard_normal(n) + 0.3


def close(test, got, expected, tolerance, what):
    got, expected = numpy.array(got, dtype=float), numpy.asarray(expected)
    test.assertEqual(got.shape, expected.shape, what)
    test.assertLessEqual(numpy.abs(got - expected).max(), tolerance, what)


class Coefficients(unittest.TestCase):
    def setUp(self):
        if pywt is None:
            self.skipTest("skipped, because /usr/bin/python3 has no pywt")

    def test_equal_pywavelets_for_every_wavelet_and_mode(self):
        names = ["haar", *(f"db{n}" for n in range(1, 21)), *(f"sym{n}" for n in range(2, 21)),
                 *(f"coif{n}" for n in range(1, 6))]
        lengths = (5, 64, 333, 1024)
        for number, wavelet in enumerate(names):
            for mode in ("symmetric", "periodization", "zero"):
                signal = noise(lengths[number % len(lengths)], number)
                levels = 1 + number % 4
                path = write("one.csv", {"accel_x_m_per_s2": signal}, sample_rate_hz=1000)
                got = report(path, "--coefficients", "--wavelet", wavelet, "--levels", levels, "--mode", mode)
                approximation, details = signal, []
                for _ in range(levels):
                    approximation, detail = pywt.dwt(approximation, wavelet, mode)
                    details.append(detail)
                what = f"{wavelet} {mode} {len(signal)}"
                self.assertEqual(list(got), ["approximation", "details"])
                close(self, got["approximation"], approximation, 1e-12, what)
                for level, detail in enumerate(details):
                    close(self, got["details"][level], detail, 1e-12, what)

    def test_packets_are_pywavelets_leaves_in_natural_order(self):
        signal = noise(1000)
        path = write("several.csv", {"accel_x_m_per_s2": noise(1000, 1), "current_A": signal}, sample_rate_hz=1000)
        for mode in ("symmetric", "periodization"):
            got = report(path, "--coefficients", "--packet", "--wavelet", "db6", "--levels", 3, "--mode", mode,
                         "--channel", "current_A")
            nodes = pywt.WaveletPacket(signal, "db6", mode, maxlevel=3).get_level(3, order="natural")
            self.assertEqual(got["paths"], [node.path for node in nodes])
            for leaf, node in zip(got["leaves"], nodes, strict=True):
                close(self, leaf, node.data, 1e-12, node.path)


class Features(unittest.TestCase):
    def test_of_the_first_level_are_numpy_s(self):
        channels = {"accel_y_m_per_s2": noise(3000, 2), "current_A": 4.0 + noise(3000, 3)}
        got = report(write("two.csv", {"time_s": numpy.arange(3000) / 500.0, **channels}))
        self.assertEqual(len(got["names"]), 2 * 7 * 35)
        values = dict(zip(got["names"], got["values"], strict=True))
        low = numpy.array(report(FOLDER / "two.csv", "--coefficients", "--levels", 1, "--channel",
                                 "current_A")["approximation"])
        expected = {"mean": low.mean(), "median": numpy.median(low), "variance": low.var(),
                    "quantile__q_0.95": numpy.quantile(low, 0.95), "abs_energy": low @ low,
                    "mean_crossing": numpy.count_nonzero(numpy.diff(low > low.mean())),
                    "first_location_of_maximum": low.argmax() / low.size,
                    "c3__lag_3": numpy.mean(low[6:] * low[3:-3] * low[:-6])}
        for column, value in expected.items():
            self.assertAlmostEqual(values[f"current_A.a1.{column}"] / value, 1.0, delta=1e-11, msg=column)

    def test_of_the_golden_signals_are_tsfresh_s(self):
        if not (GOLDEN / "tsfresh_features.csv").exists():
            self.skipTest("skipped, because there are no golden values")
        table = {row["series"]: row for row in rows_of("tsfresh_features.csv")}
        for n in (1000, 1023, 4096):
            signal = [float(row["x"]) for row in rows_of(f"signal_{n}.csv")]
            path = write("golden.csv", {"accel_x_m_per_s2": signal}, sample_rate_hz=1000)
            for mode in ("symmetric", "periodization"):
                got = report(path, "--mode", mode, "--levels", 5)
                self.assertEqual(len(got["names"]), 5 * 35)
                for name, value in zip(got["names"], got["values"], strict=True):
                    _, level, column = name.split(".", 2)
                    expected = float(table[f"sym8_{mode}_{n}_cA{level[1:]}"][column])
                    if value is None:
                        self.assertTrue(numpy.isnan(expected), name)
                    else:
                        self.assertLessEqual(abs(value - expected), 1e-9 * max(abs(expected), 1e-9), name)

    def test_by_order_find_the_order_of_a_tone(self):
        time_s = numpy.arange(40000) / 20000.0
        tone = 2.0 * numpy.sin(2.0 * numpy.pi * 3.0 * 40.0 * time_s)
        path = write("orders.csv", {"accel_x_m_per_s2": tone}, sample_rate_hz=20000, input_speed_rpm=2400)
        got = report(path, "--set", "orders")
        values = dict(zip(got["names"], got["values"], strict=True))
        self.assertAlmostEqual(values["accel_x_m_per_s2.orders.2.5_3.5"], 2.0, delta=1e-3)
        self.assertLess(values["accel_x_m_per_s2.orders.1.5_2.5"], 1e-3)
        self.assertIsNone(values["accel_x_m_per_s2.orders.240.5_340.5"])

    def test_several_records_are_an_array_and_text_is_a_table(self):
        first = write("first.csv", {"accel_x_m_per_s2": noise(300)}, sample_rate_hz=1000)
        second = write("second.csv", {"accel_x_m_per_s2": noise(301)}, sample_rate_hz=1000)
        both = report(first, second)
        self.assertEqual(both, [report(first), report(second)])
        code, out, _ = run(first)
        self.assertEqual(code, 0)
        self.assertIn("root_mean_square", out)
        self.assertIn("Example: strainwave features", run("--help")[1])


class BadInput(unittest.TestCase):
    def expect(self, message, *arguments):
        code, out, error = run(*arguments)
        self.assertEqual((code, out), (2, ""))
        self.assertIn(message, error.replace(str(FOLDER) + "/", ""))

    def test_names_file_line_and_what_was_expected(self):
        path = write("bad.csv", {"accel_x_m_per_s2": noise(5)}, sample_rate_hz=1000)
        path.write_text(path.read_text() + "nan\n")
        self.expect("bad.csv:9:1: error: accel_x_m_per_s2 is nan (expected a finite number)", path)
        self.expect("none.csv: error:", FOLDER / "none.csv")
        loop = FOLDER / "loop.csv"
        loop.write_text("# kind: hysteresis\ntime_s,torque_Nm,output_angle_deg\n0,0,0\n1,1,0.1\n")
        self.expect("loop.csv: error: kind is hysteresis (expected vibration)", loop)

    def test_names_channels_wavelets_and_speeds(self):
        path = write("good.csv", {"accel_x_m_per_s2": noise(50), "current_A": noise(50)}, sample_rate_hz=1000)
        self.expect("good.csv: error: there are 2 channels and none is named (expected --channel with one of "
                    "accel_x_m_per_s2, current_A)", path, "--coefficients")
        self.expect("good.csv: error: there is no channel 'z' (expected accel_x_m_per_s2, current_A)", path,
                    "--coefficients", "--channel", "z")
        self.expect("error: wavelet = 'sym21' is not known (expected haar, db1 to db20, sym2 to sym20 or coif1 to "
                    "coif5)", path, "--wavelet", "sym21")
        self.expect("good.csv: error: there is no speed of the input shaft (expected metadata or column "
                    "input_speed_rpm, or column input_speed_rad_per_s)", path, "--set", "orders")
        self.expect("--levels", path, "--levels", 0)
        self.expect("--packet requires --coefficients", path, "--packet")
        short = write("short.csv", {"accel_x_m_per_s2": noise(50)}, sample_rate_hz=1000, input_speed_rpm=600)
        self.expect("short.csv: error: accel_x_m_per_s2: signal has 0.5 turns of the input shaft (expected at least 4)",
                    short, "--set", "orders")
        still = write("still.csv", {"accel_x_m_per_s2": noise(50)}, sample_rate_hz=1000, input_speed_rpm=0)
        self.expect("still.csv: error: the input shaft stands still (expected a speed other than zero)", still, "--set",
                    "orders")
        turning = write("turning.csv", {"accel_x_m_per_s2": noise(50), "input_speed_rpm": numpy.linspace(60.0, 66.0, 50)},
                        sample_rate_hz=10)
        self.expect("turning.csv: error: the input shaft turns at 6.283 to 6.912 rad/s (expected one speed, to a "
                    "hundredth, for energies by order)", turning, "--set", "orders")
        gap_s = numpy.arange(50) / 100.0
        gap_s[30:] += 1.0
        gap = write("gap.csv", {"time_s": gap_s, "accel_x_m_per_s2": noise(50)}, input_speed_rpm=6000)
        self.expect("(expected even samples)", gap, "--set", "orders")


if __name__ == "__main__":
    options = argparse.ArgumentParser()
    options.add_argument("program")
    options.add_argument("--seed", type=int, default=1)
    chosen = options.parse_args()
    PROGRAM, SEED = chosen.program, chosen.seed
    with tempfile.TemporaryDirectory() as folder:
        FOLDER = pathlib.Path(folder)
        unittest.main(argv=[sys.argv[0]], verbosity=2)
