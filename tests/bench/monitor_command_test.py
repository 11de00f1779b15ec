#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave monitor` as a user would run it, with the peers of a plant: mosquitto, pymodbus, an HTTP client, and a
program in C.

usage: monitor_command_test.py PROGRAM EXAMPLE     exit code 77: skipped, a peer is not there"""
import ctypes
import json
import math
import os
import pathlib
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import unittest
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "peers"))
import exported_campaign  # noqa: E402
import mqtt_peer  # noqa: E402
import needed  # noqa: E402
from free_port import free_port  # noqa: E402
from waiting import until  # noqa: E402

with needed.peers("/usr/sbin/mosquitto"):
    import h5py
    import numpy
    from pymodbus.client import ModbusTcpClient

PROGRAM, EXAMPLE, FOLDER = "", "", pathlib.Path()
CHANNELS = ["accel_x_m_per_s2", "accel_y_m_per_s2", "accel_z_m_per_s2", "accel_motor_z_m_per_s2"]
OUTPUTS = ["e_max_arcmin", "e_avg_arcmin", "k1_Nm_per_rad", "k2_Nm_per_rad", "k3_Nm_per_rad"]


def settings(name, text):
    (FOLDER / name).write_text("monitor: 1\n" + text)
    return FOLDER / name


class Running:
    """A monitor that runs; its lines of standard error come in as they are written."""

    def __init__(self, *arguments):
        self.errors = open(FOLDER / "errors.txt", "w+")
        self.results = open(FOLDER / "results.txt", "w+")
        self.process = subprocess.Popen([PROGRAM, "monitor", *map(str, arguments), "--json"], stdout=self.results,
                                        stderr=self.errors, text=True)

    def said(self, pattern):
        return re.search(pattern, pathlib.Path(self.errors.name).read_text())

    def lines(self):
        text = pathlib.Path(self.results.name).read_text()
        return [json.loads(line) for line in text.splitlines() if line.endswith("}")]

    def end(self, number=signal.SIGINT):
        if self.process.poll() is None:
            self.process.send_signal(number)
        code = self.process.wait(20)
        self.errors.close()
        self.results.close()
        return code


class Monitor(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.campaign, cls.exported = exported_campaign.make(PROGRAM, FOLDER)
        cls.record = cls.campaign / "cycles" / "000010.h5"
        cls.good = cls.vibration(10)

    @classmethod
    def vibration(cls, cycle):
        with h5py.File(cls.campaign / "cycles" / f"{cycle:06d}.h5") as file:
            record = file["measurement_rotation/vibration"]
            return {channel: record[channel][:].astype(float) for channel in CHANNELS}

    def write(self, name, columns, rate_hz=25600.0):
        lines = ["# kind: vibration", f"# sample_rate_hz: {rate_hz}", "# input_speed_rpm: 2400", ",".join(columns)]
        lines += [",".join(map(repr, map(float, row))) for row in zip(*columns.values(), strict=True)]
        (FOLDER / name).write_text("\n".join(lines) + "\n")
        return FOLDER / name

    def run_once(self, *arguments):
        done = subprocess.run([PROGRAM, "monitor", *map(str, arguments), "--json"], capture_output=True, text=True,
                              check=False)
        return done.returncode, [json.loads(line) for line in done.stdout.splitlines()], done.stderr

    def test_replayed_records_give_what_predict_gives(self):
        code, results, error = self.run_once(self.exported, "--replay", self.record, "--pace", "max")
        self.assertEqual(code, 0, error)
        self.assertIn("files unchanged", error)
        predicted = json.loads(subprocess.run([PROGRAM, "predict", FOLDER / "predictor", self.record, "--json"],
                                              capture_output=True, text=True, check=True).stdout)
        self.assertEqual([result["status"] for result in results], ["good"])
        self.assertEqual(results[0]["coverage"], 0.9)
        for name in OUTPUTS:
            for key in ("value", "low", "high"):
                self.assertAlmostEqual(results[0]["values"][name][key] / predicted["values"][name][key], 1, delta=1e-5)

    def test_a_window_a_turn_of_the_simulated_bench(self):
        code, results, error = self.run_once(self.exported, "--simulate", "--pace", "max", "--duration", 9)
        self.assertEqual(code, 0, error)
        self.assertEqual([result["window"] for result in results], [1, 2, 3, 4])
        for name in OUTPUTS:  # as the first cycles of the campaign, that is the same bench
            self.assertAlmostEqual(results[0]["values"][name]["value"] / self.expected(name), 1, delta=0.05)

    def expected(self, name):
        _, results, _ = self.run_once(self.exported, "--replay", self.record, "--pace", "max")
        return results[0]["values"][name]["value"]

    def test_energies_by_order_are_of_the_shaft_s_speed(self):
        predictor, exported = FOLDER / "by_order", FOLDER / "by_order_exported"
        for command in (["train", self.campaign, "--set", "orders", "--epochs", 10, "--out", predictor],
                        ["export", predictor, "--out", exported, "--anyway"]):
            done = subprocess.run([PROGRAM, *map(str, command)], capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
        predicted = json.loads(subprocess.run([PROGRAM, "predict", predictor, self.record, "--json"],
                                              capture_output=True, text=True, check=True).stdout)["values"]
        code, results, error = self.run_once(exported, "--replay", self.record, "--pace", "max")
        self.assertEqual(code, 0, error)
        from_c = self.values_from_c(exported, 2400.0)
        for place, name in enumerate(OUTPUTS):
            value = predicted[name]["value"]
            self.assertAlmostEqual(results[0]["values"][name]["value"] / value, 1, delta=1e-5)
            self.assertAlmostEqual(from_c[place] / value, 1, delta=1e-5)
        self.assertEqual(self.values_from_c(exported, 0.0),
                         "input_speed_rpm is 0 or no number (expected the speed of a shaft that turns)")
        silent = self.write("silent.csv", self.good)
        silent.write_text(silent.read_text().replace("# input_speed_rpm: 2400\n", ""))
        code, results, error = self.run_once(exported, "--replay", silent, "--pace", "max")
        self.assertEqual((code, results[0]["status"]), (2, "bad"))
        self.assertIn(f"{silent}: error: there is no steady speed of the input shaft (expected ", error)

    def values_from_c(self, exported, input_speed_rpm):
        """The outputs, or why there are none."""
        library = ctypes.CDLL(str(pathlib.Path(PROGRAM).parent / "libstrainwave_predictor.so"))
        library.strainwave_predictor_open.restype = ctypes.c_void_p
        error = ctypes.create_string_buffer(400)
        predictor = ctypes.c_void_p(library.strainwave_predictor_open(str(exported).encode(), error, 400))
        self.assertTrue(predictor.value, error.value)
        samples = [numpy.ascontiguousarray(self.good[name]) for name in CHANNELS]
        pointer = ctypes.POINTER(ctypes.c_double)
        channels = (pointer * len(samples))(*(each.ctypes.data_as(pointer) for each in samples))
        values = (ctypes.c_double * (3 * len(OUTPUTS)))()
        status = library.strainwave_predictor_run_at(
            predictor, channels, ctypes.c_size_t(len(samples[0])), ctypes.c_double(25600.0),
            ctypes.c_double(input_speed_rpm), values, None, error, ctypes.c_size_t(400))
        library.strainwave_predictor_close(predictor)
        return list(values)[::3] if status in (0, 1) else error.value.decode()

    def test_a_trigger_channel_cuts_a_long_record(self):
        columns = {name: numpy.tile(values, 3)[:120000] for name, values in self.good.items()}
        columns["trigger_V"] = numpy.zeros(120000)
        columns["trigger_V"][5000:5100] = columns["trigger_V"][60000:60100] = 5.0
        path = self.write("long.csv", columns)
        rule = settings("trigger.yaml", "windows:\n  trigger_channel: trigger_V\n  trigger_level: 2.5\n")
        _, results, error = self.run_once(self.exported, "--replay", path, "--pace", "max", "--settings", rule)
        self.assertEqual(len(results), 2, error)
        self.assertTrue(results[0]["begin_utc"] < results[0]["end_utc"] <= results[1]["begin_utc"])

    def test_bad_records_are_named_and_nothing_of_them_is_good(self):
        good = self.good
        bad = {
            "rate": (self.write("rate.csv", good, rate_hz=12800.0), "sample_rate"),
            "missing": (self.write("missing.csv", {name: good[name] for name in CHANNELS[1:]}), "missing_channel"),
            "short": (self.write("short.csv", {name: values[:5000] for name, values in good.items()}), "too_short"),
            "clipped": (self.write("clipped.csv", good | {CHANNELS[2]: numpy.clip(good[CHANNELS[2]], -0.25, 0.25)}),
                        "clipped"),
            "dead": (self.write("dead.csv", good | {CHANNELS[1]: 0 * good[CHANNELS[1]]}), "dead"),
            "swapped": (self.write("swapped.csv", good | {CHANNELS[0]: good[CHANNELS[3]], CHANNELS[3]: good[CHANNELS[0]]}),
                        "swapped"),
            "nan": (self.write("nan.csv", good | {CHANNELS[0]: numpy.where(numpy.arange(len(good[CHANNELS[0]])) == 7,
                                                                           numpy.nan, good[CHANNELS[0]])}),
                    "unreadable"),
            "none": (FOLDER / "none.csv", "unreadable"),
        }
        files = [path for path, _ in bad.values()]
        code, results, error = self.run_once(self.exported, "--replay", *files, self.record, "--pace", "max")
        self.assertEqual(code, 2)
        self.assertEqual([result.get("fault") for result in results], [fault for _, fault in bad.values()] + [None])
        for result in results[:-1]:
            self.assertEqual((result["status"], "values" in result), ("bad", False))
        self.assertEqual(results[-1]["status"], "good")
        for path in files:
            self.assertRegex(error, rf"(?m)^{re.escape(str(path))}:.*error: .+ \(expected .+\)$")

    def test_a_changed_folder_is_refused_before_anything_is_published(self):
        changed = FOLDER / "changed"
        shutil.copytree(self.exported, changed)
        model = bytearray((changed / "model.onnx").read_bytes())
        model[len(model) // 2] ^= 1
        (changed / "model.onnx").write_bytes(model)
        code, results, error = self.run_once(changed, "--replay", self.record, "--pace", "max")
        self.assertEqual((code, results), (2, []))
        self.assertEqual(error, f"{changed}/model.onnx: error: the file has changed since it was written (expected the "
                                "SHA-256 that recipe.json has of it)\n")

    def test_wrong_command_lines_and_settings_are_told(self):
        code, _, error = self.run_once(self.exported)
        self.assertEqual((code, error), (2, "error: there must be one stream (expected --source with an address, "
                                            "--replay with records, --simulate, or a section `source` in the settings)\n"))
        wrong = settings("wrong.yaml", "thresholds:\n  - output: k9\n    warning_above: 1\n")
        code, _, error = self.run_once(self.exported, "--replay", self.record, "--settings", wrong)
        self.assertEqual((code, error), (2, f"error: a threshold is for 'k9' (expected one of the outputs "
                                            f"{', '.join(OUTPUTS)})\n"))
        wrong = settings("port.yaml", "modbus:\n  port: many\n")
        code, _, error = self.run_once(self.exported, "--replay", self.record, "--settings", wrong)
        self.assertEqual((code, error), (2, f"{wrong}:3:9: error: port = many: not a number (expected a plain number, "
                                            "as in '0.5')\n"))

    def test_a_port_that_is_taken_is_an_error_of_the_machine(self):
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            taken.listen()
            port = taken.getsockname()[1]
            for section in ("prometheus", "modbus"):
                rule = settings("taken.yaml", f"{section}:\n  port: {port}\n")
                code, results, error = self.run_once(self.exported, "--replay", self.record, "--settings", rule)
                self.assertEqual((code, results), (3, []))
                self.assertIn(f"error: {section} cannot listen on 127.0.0.1 port {port}", error)

    def test_thresholds_warn_and_alarm(self):
        value = self.expected("k2_Nm_per_rad")
        rule = settings("limits.yaml", f"thresholds:\n  - output: k2_Nm_per_rad\n    warning_below: {2 * value}\n"
                                       f"    alarm_below: {1.5 * value}\n    hold: 25 s\n")
        _, results, error = self.run_once(self.exported, "--replay", self.record, "--rounds", 5, "--every", 10,
                                          "--pace", "max", "--settings", rule)
        self.assertEqual([result["alarm"] for result in results], ["ok"] * 3 + ["alarm"] * 2, error)
        self.assertEqual(results[4]["values"]["k2_Nm_per_rad"]["alarm"], "alarm")
        self.assertEqual(results[4]["values"]["k1_Nm_per_rad"]["alarm"], "ok")

    # One good window and one clipped, 100 s of the stream apart, at 50 times real time, stale after 60 s.
    def stream(self, *sections):
        clipped = self.write("bad.csv", self.good | {CHANNELS[2]: numpy.clip(self.good[CHANNELS[2]], -0.25, 0.25)})
        rule = settings("all.yaml", "stale_after: 60 s\n" + "".join(sections))
        return Running(self.exported, "--replay", self.record, clipped, "--every", 100, "--pace", "50", "--rounds", 50,
                       "--settings", rule)

    def test_prometheus_shows_values_only_while_they_are_good(self):
        monitor = self.stream("prometheus:\n  port: 0\n")
        try:
            url = until(lambda: monitor.said(r"prometheus: (http://\S+)")).group(1)

            def page():
                with urllib.request.urlopen(url, timeout=5) as answer:
                    self.assertIn("version=0.0.4", answer.headers["Content-Type"])
                    return answer.read().decode()

            good = until(lambda: (text := page()) and 'strainwave_status{status="good"} 1' in text and text)
            self.assertEqual(set(re.findall(r'strainwave_predicted\{output="(\w+)"\}', good)), set(OUTPUTS))
            stale = until(lambda: (text := page()) and "\nstrainwave_stale 1\n" in text and text)
            self.assertNotIn("strainwave_predicted", stale)
            bad = until(lambda: (text := page()) and 'strainwave_status{status="bad"} 1' in text and text)
            self.assertNotIn("strainwave_predicted", bad)
            counts = dict(re.findall(r'strainwave_windows_total\{status="(good|bad)"\} (\d+)\n', bad))
            self.assertGreater(int(counts["bad"]), 0)
            self.assertEqual(counts["bad"], counts["good"], "they come in turn")
        finally:
            code = monitor.end()
        self.assertEqual(code, 130)

    def test_every_signal_ends_it_as_ctrl_c_does(self):
        for number in (signal.SIGHUP, signal.SIGTSTP, signal.SIGUSR1, signal.SIGTERM):
            monitor = self.stream()
            until(monitor.lines)
            self.assertEqual(monitor.end(number), 130, number)
            self.assertRegex(pathlib.Path(monitor.errors.name).read_text(), r"windows: \d+ good, \d+ bad")

    def test_a_plc_reads_registers_with_their_status(self):
        monitor = self.stream("modbus:\n  port: 0\n")
        try:
            port = int(until(lambda: monitor.said(r"modbus: .* port (\d+)")).group(1))
            silent = socket.create_connection(("127.0.0.1", port))  # says nothing, and keeps nobody waiting
            silent.sendall(b"\0\1\0")
            plc = ModbusTcpClient("127.0.0.1", port=port)
            self.assertTrue(plc.connect())

            def table(status):
                registers = plc.read_input_registers(0, 60, slave=1).registers
                return registers if registers[1] == status else None

            def number(registers, at):
                return struct.unpack(">f", struct.pack(">HH", *registers[at:at + 2]))[0]

            good = until(lambda: table(1))
            self.assertEqual((good[0], good[3], good[11]), (1, 0, 5))
            values = until(monitor.lines)[0]["values"]
            for k, name in enumerate(OUTPUTS):
                self.assertAlmostEqual(number(good, 20 + 8 * k) / values[name]["value"], 1, delta=1e-6)
                self.assertAlmostEqual(number(good, 22 + 8 * k) / values[name]["low"], 1, delta=1e-6)
            stale = until(lambda: table(3))
            self.assertTrue(math.isnan(number(stale, 20)))
            bad = until(lambda: table(2))
            self.assertEqual(bad[3], 6)
            self.assertTrue(math.isnan(number(bad, 20)))
            self.assertTrue(plc.read_holding_registers(0, 1, slave=1).isError())
            self.assertTrue(plc.read_input_registers(60, 1, slave=1).isError())
            plc.close()
            silent.close()
        finally:
            monitor.end()

    def test_sparkplug_values_carry_their_quality(self):
        broker = mqtt_peer.Broker()
        broker.start()
        self.addCleanup(broker.close)
        host = mqtt_peer.Client(broker.port, "listener")
        self.addCleanup(host.close)
        host.subscribe("spBv1.0/lab/#")
        monitor = self.stream(f"mqtt:\n  port: {broker.port}\n  group: lab\n  node: bench\n")
        seen = []

        def take(kind):
            for topic, payload, _ in host.poll(0.05):
                seen.append((topic.split("/")[2], mqtt_peer.decode(payload)))
            return [payload for name, payload in seen if name == kind]

        try:
            birth = until(lambda: take("NBIRTH"))[0]
            data = until(lambda: len(take("NDATA")) >= 3 and take("NDATA"))
            rebirth = b"\x0a\x14Node Control/Rebirth\x20\x0b\x70\x01"  # name, data type boolean, true
            host.publish("spBv1.0/lab/NCMD/bench", b"\x12" + bytes([len(rebirth)]) + rebirth)
            until(lambda: len(take("NBIRTH")) == 2)
        finally:
            code = monitor.end()
        self.assertEqual(code, 130)
        death = until(lambda: take("NDEATH"))[-1]
        self.assertEqual(birth["seq"], 0)
        self.assertTrue(birth["metrics"]["k2_Nm_per_rad/Value"]["null"])
        self.assertEqual(death["metrics"]["bdSeq"]["value"], birth["metrics"]["bdSeq"]["value"])
        again = take("NBIRTH")[1]
        self.assertEqual((again["seq"], again["metrics"]["bdSeq"]["value"]), (0, birth["metrics"]["bdSeq"]["value"]))
        self.assertEqual([payload["seq"] for payload in data[:3]], [1, 2, 3])
        for payload, null, quality, text in zip(data, (False, True, True), (192, 500, None), ("good", "stale", "clipped: ")):
            value = payload["metrics"]["k2_Nm_per_rad/Value"]
            self.assertEqual((value["null"], value["quality"] or None), (null, quality))
            self.assertTrue(payload["metrics"]["Quality"]["value"].startswith(text))
        self.assertEqual(data[2]["metrics"]["k2_Nm_per_rad/Value"]["quality"], 0)

    def test_a_dead_broker_holds_nothing_up(self):
        rule = settings("dead.yaml", f"mqtt:\n  port: {free_port()}\n  node: bench\n  keep_windows: 7\n"
                                     "prometheus:\n  port: 0\n")
        code, results, error = self.run_once(self.exported, "--replay", self.record, "--rounds", 10, "--pace", "max",
                                             "--settings", rule, "--linger", 0)
        self.assertEqual((code, len(results)), (0, 10), error)
        self.assertRegex(error.splitlines()[-1], r"^mqtt: error: 7 windows were not delivered and are lost: (no connection to|no "
                                                 r"answer yet from) 127.0.0.1 port \d+")

    def test_a_program_in_c_gets_the_same_values(self):
        _, results, _ = self.run_once(self.exported, "--replay", self.record, "--pace", "max")
        path = FOLDER / "plain.csv"
        path.write_text("\n".join(",".join(map(repr, map(float, row))) for row in zip(*self.good.values())) + "\n")
        done = subprocess.run([EXAMPLE, self.exported, path, "25600"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stderr.split(), sum((["channel", name] for name in CHANNELS), []))
        for line, name in zip(done.stdout.splitlines(), OUTPUTS, strict=True):
            got = line.split()
            expected = results[0]["values"][name]
            self.assertEqual([got[0], *map(float, got[1:])], [name, expected["value"], expected["low"], expected["high"]])
        done = subprocess.run([EXAMPLE, self.exported, path, "12800"], capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn("the sampling rate is 12800 Hz (expected 25600 Hz, as in training)", done.stderr)
        done = subprocess.run([EXAMPLE, FOLDER, path, "25600"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("recipe.json: error: cannot be read", done.stderr)


if __name__ == "__main__":
    PROGRAM, EXAMPLE = os.path.abspath(sys.argv.pop(1)), os.path.abspath(sys.argv.pop(1))
    with tempfile.TemporaryDirectory() as folder:
        FOLDER = pathlib.Path(folder)
        unittest.main()
