#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What `strainwave monitor` is connected to: a device that sends samples (the reference sender), a replayed record, the
simulated bench, and what becomes of samples that are lost or cannot be.

usage: monitor_links_test.py PROGRAM     exit code 77: skipped, a peer is not there"""
import json
import pathlib
import signal
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "peers"))
import needed  # noqa: E402
from free_port import free_port  # noqa: E402
from waiting import until  # noqa: E402

with needed.peers("/usr/sbin/mosquitto"):
    import numpy
    import monitor_fixture
    from stream_devices import CHANNELS, RATE_HZ, Device, Iiod


class Links(monitor_fixture.MonitorTest):
    def test_samples_of_a_device_give_the_values_of_the_record(self):
        device = Device(self.samples, 3 * self.blocks + 7)
        monitor = self.start("--source", f"tcp://127.0.0.1:{device.port}")
        self.assertEqual(monitor.wait(60), 0, monitor.said())
        results = monitor.results()
        self.assertEqual([result["status"] for result in results], ["good"] * 3)
        for result in results:
            self.assertEqual(result["values"], self.predicted())
            self.assertEqual(result["origin"], "front end")

    def test_an_iio_device_gives_the_values_of_the_record(self):
        device = Iiod(self.samples)
        self.addCleanup(device.server_close)
        self.addCleanup(device.shutdown)
        monitor = self.start("--source", f"iio:ip:127.0.0.1:{device.server_address[1]}/adxl355")
        results = until(lambda: (done := monitor.results()) and len(done) >= 2 and done or monitor.poll() is not None)
        monitor.send_signal(signal.SIGINT)
        self.assertEqual(monitor.wait(60), 130, monitor.said())
        for result in results:
            self.assertEqual(result["status"], "good")
            for name, value in result["values"].items():
                self.assertAlmostEqual(value["value"] / self.predicted()[name]["value"], 1, delta=1e-4)

    def test_a_replayed_file_gives_the_values_of_the_record(self):
        path = self.folder / "replayed.csv"
        with open(path, "w", encoding="ascii") as file:
            file.write(f"# kind: vibration\n# sample_rate_hz: {RATE_HZ}\n" + ",".join(["time_s", *CHANNELS]) + "\n")
            for number, row in enumerate(self.samples):
                file.write(",".join([repr(number / RATE_HZ), *(repr(float(value)) for value in row)]) + "\n")
        monitor = self.start("--source", f"replay:{path}", "--pace", "max")
        self.assertEqual(monitor.wait(60), 0, monitor.said())
        self.assertEqual([result["values"] for result in monitor.results()], [self.predicted()])

    def test_records_and_the_simulated_bench_have_the_motor_s_torque(self):
        predictor, exported = self.folder / "by_torque", self.folder / "by_torque_exported"
        for command in (["train", self.campaign, "--motor-torque", "--out", predictor, "--epochs", "5"],
                        ["export", predictor, "--out", exported, "--anyway"]):
            subprocess.run([self.program, *map(str, command)], check=True, capture_output=True)
        self.assertIn("motor_torque_Nm", json.loads((exported / "recipe.json").read_text())["recipe"]["channels"])
        predicted = json.loads(subprocess.run([self.program, "predict", predictor, self.record, "--json"], capture_output=True,
                                              check=True).stdout)["values"]
        done = subprocess.run([self.program, "monitor", exported, "--replay", self.record, "--pace", "max", "--json"],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        for name, value in json.loads(done.stdout)["values"].items():
            self.assertAlmostEqual(value["value"] / predicted[name]["value"], 1, delta=1e-5)
        done = subprocess.run([self.program, "monitor", exported, "--simulate", "--output-torque", "40", "--duration", "5", "--pace",
                               "max", "--json"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([result.get("error") for result in map(json.loads, done.stdout.splitlines())], [None, None])

    def test_a_value_that_no_sensor_gives_makes_its_window_bad_and_the_monitor_goes_on(self):
        samples = numpy.concatenate([self.samples] * 3)
        samples[self.window + 17, 2] = 1e30
        device = Device(samples, 3 * self.blocks)
        monitor = self.start("--source", f"tcp://127.0.0.1:{device.port}")
        self.assertEqual(monitor.wait(60), 0, monitor.said())
        self.assertEqual([(result["status"], result.get("fault"), result.get("error")) for result in monitor.results()], [
            ("good", None, None),
            ("bad", "not_finite", "accel_z_m_per_s2 is 1.0000000150474662e+30 at sample 18 (expected a number from "
                                  "-1e+07 to 1e+07 m/s^2)"),
            ("good", None, None)])

    def test_a_device_whose_calibration_cannot_be_is_refused(self):
        for term, words in ((("sensitivity", "1e-200"), "sensitivity = 1e-200 is not a number of a magnitude from 1e-15"),
                            (("polynomial", "0 1 1e300"), "polynomial = 1e+300 is not a number of a magnitude from 0")):
            device = Device(self.samples, 1, calibration={"calibration": "C", **dict([term])})
            monitor = self.start("--source", f"tcp://127.0.0.1:{device.port}")
            self.assertEqual(monitor.wait(60), 3, monitor.said())
            self.assertEqual(monitor.said(), f"error: 127.0.0.1:{device.port} sends no hello (hello: {words} to 1e+15): "
                                             "Protocol error\n")

    def test_a_window_with_lost_samples_is_not_predicted(self):
        n = self.blocks
        lost, broken, cut = n + 20, 2 * n + 30, 3 * n + 10
        device = Device(self.samples, 5 * n, drop={lost}, corrupt={broken}, disconnect={cut})
        monitor = self.start("--source", f"tcp://127.0.0.1:{device.port}")
        self.assertEqual(monitor.wait(60), 0, monitor.said())
        # A window that begins elsewhere in the record may lie outside the training; it has values all the same.
        told = [("bad" if result["status"] == "bad" else "good", result.get("error")) for result in monitor.results()]
        gap = "512 samples were lost (expected the whole window)"
        self.assertEqual(told, [
            ("good", None), ("bad", gap), ("good", None), ("bad", gap),
            ("bad", "the stream broke off (expected the whole window)"),
            ("bad", f"127.0.0.1:{device.port}: the connection was closed (expected samples; the device is tried again)"),
            ("good", None)])

    def test_a_silent_device_is_bad_and_no_value(self):
        device = Device(self.samples, 2 * self.blocks, pause_at=self.blocks)
        broker, host = self.broker()
        path = self.settings(f"source:\n  address: tcp://127.0.0.1:{device.port}\n  silent_after: 300 ms\n"
                             f"mqtt:\n  port: {broker.port}\n  group: lab\n  node: bench\n")
        monitor = self.start("--settings", path)
        data = []
        until(lambda: data.extend(self.data_of(host)) or len(data) >= 2)
        device.go.set()
        self.assertEqual(monitor.wait(60), 0, monitor.said())
        until(lambda: data.extend(self.data_of(host)) or len(data) >= 3)
        values = [each["metrics"]["k2_Nm_per_rad/Value"] for each in data]
        self.assertEqual([(value["null"], value["quality"]) for value in values], [(False, 192), (True, 0), (False, 192)])
        self.assertEqual(data[1]["metrics"]["Quality"]["value"],
                         "unreadable: front end has sent no samples for 0.3 s (expected 25600 a second)")

    def test_a_device_that_does_not_fit_is_told_at_once(self):
        device = Device(self.samples, 1, names=["accel_x", "accel_y", "accel_z", "accel_w"])
        monitor = self.start("--source", f"tcp://127.0.0.1:{device.port}")
        self.assertEqual(monitor.wait(60), 2)
        self.assertEqual(monitor.said(), "front end: error: there is no channel accel_motor_z_m_per_s2 among "
                         "accel_x_m_per_s2, accel_y_m_per_s2, accel_z_m_per_s2, accel_w_m_per_s2 (expected it; `source: "
                         "channels:` of the settings renames others)\n")
        device = Device(self.samples, self.blocks, names=["accel_x", "accel_y", "accel_z", "accel_w"])
        path = self.settings(f"source:\n  address: tcp://127.0.0.1:{device.port}\n  channels:\n"
                             "    - {source: accel_w, name: accel_motor_z_m_per_s2}\n")
        monitor = self.start("--settings", path)
        self.assertEqual(monitor.wait(60), 0, monitor.said())
        self.assertEqual(monitor.results()[0]["values"], self.predicted())
        port = free_port()
        monitor = self.start("--source", f"tcp://127.0.0.1:{port}")
        self.assertEqual(monitor.wait(60), 3)
        self.assertEqual(monitor.said(), f"error: cannot connect to 127.0.0.1:{port}: Connection refused\n")
        monitor = self.start("--source", "127.0.0.1:5000")
        self.assertEqual(monitor.wait(60), 2)
        self.assertEqual(monitor.said(), "error: address = 127.0.0.1:5000 (expected tcp://HOST:PORT, iio:URI/DEVICE as in "
                         "iio:ip:10.0.0.7/adxl355, or replay:FILE)\n")


if __name__ == "__main__":
    monitor_fixture.main()
