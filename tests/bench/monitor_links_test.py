#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What `strainwave monitor` is connected to, and what becomes of results when a connection is not there: a device that
sends samples (the reference sender), a broker that is stopped, a monitor that is killed, certificates that are wrong.

usage: monitor_links_test.py PROGRAM     exit code 77: skipped, a peer is not there"""
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "peers"))
import exported_campaign  # noqa: E402
import mqtt_peer  # noqa: E402
import needed  # noqa: E402
import test_certificates  # noqa: E402
from waiting import until  # noqa: E402

with needed.peers("/usr/sbin/mosquitto"):
    import h5py
    import numpy
    from stream_devices import BLOCK, CHANNELS, RATE_HZ, Device, Iiod

PROGRAM, FOLDER = "", pathlib.Path()


class Links(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.campaign, cls.exported = exported_campaign.make(PROGRAM, FOLDER)
        cls.record = cls.campaign / "cycles" / "000010.h5"
        with h5py.File(cls.record) as file:
            record = file["measurement_rotation/vibration"]
            cls.samples = numpy.stack([record[channel][:] for channel in CHANNELS], axis=1)
        cls.recipe = json.loads((cls.exported / "recipe.json").read_text())["recipe"]
        cls.window = cls.recipe["least_samples"]
        assert cls.window == len(cls.samples) and cls.window % BLOCK == 0
        cls.blocks = cls.window // BLOCK  # of a window

    def setUp(self):
        self.running = []

    def tearDown(self):
        for process in self.running:
            if process.poll() is None:
                process.kill()
            process.wait()
            process.stderr_file.close()
            process.results_file.close()

    def settings(self, text):
        path = FOLDER / f"{self.id().split('.')[-1]}.yaml"
        path.write_text("monitor: 1\n" + text)
        return path

    def start(self, *arguments, environment=None):
        """A monitor that runs; `said` and `results` read what it has written so far."""
        number = len(self.running)
        errors, results = (open(FOLDER / f"{self.id()}-{number}.{kind}", "w+") for kind in ("errors", "results"))
        process = subprocess.Popen([PROGRAM, "monitor", str(self.exported), *map(str, arguments), "--json"], stdout=results,
                                   stderr=errors, text=True, env=os.environ | (environment or {}))
        process.stderr_file, process.results_file = errors, results
        process.said = lambda: pathlib.Path(errors.name).read_text()
        process.results = lambda: [json.loads(line) for line in pathlib.Path(results.name).read_text().splitlines()
                                   if line.endswith("}")]
        self.running.append(process)
        return process

    def predicted(self):
        done = subprocess.run([PROGRAM, "monitor", self.exported, "--replay", self.record, "--pace", "max", "--json"],
                              capture_output=True, text=True, check=True)
        return json.loads(done.stdout)["values"]

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
        path = FOLDER / "replayed.csv"
        with open(path, "w", encoding="ascii") as file:
            file.write(f"# kind: vibration\n# sample_rate_hz: {RATE_HZ}\n" + ",".join(["time_s", *CHANNELS]) + "\n")
            for number, row in enumerate(self.samples):
                file.write(",".join([repr(number / RATE_HZ), *(repr(float(value)) for value in row)]) + "\n")
        monitor = self.start("--source", f"replay:{path}", "--pace", "max")
        self.assertEqual(monitor.wait(60), 0, monitor.said())
        self.assertEqual([result["values"] for result in monitor.results()], [self.predicted()])

    def test_records_and_the_simulated_bench_have_the_motor_s_torque(self):
        predictor, exported = FOLDER / "by_torque", FOLDER / "by_torque_exported"
        for command in (["train", self.campaign, "--motor-torque", "--out", predictor, "--epochs", "5"],
                        ["export", predictor, "--out", exported]):
            subprocess.run([PROGRAM, *map(str, command)], check=True, capture_output=True)
        self.assertIn("motor_torque_Nm", json.loads((exported / "recipe.json").read_text())["recipe"]["channels"])
        predicted = json.loads(subprocess.run([PROGRAM, "predict", predictor, self.record, "--json"], capture_output=True,
                                              check=True).stdout)["values"]
        done = subprocess.run([PROGRAM, "monitor", exported, "--replay", self.record, "--pace", "max", "--json"],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        for name, value in json.loads(done.stdout)["values"].items():
            self.assertAlmostEqual(value["value"] / predicted[name]["value"], 1, delta=1e-5)
        done = subprocess.run([PROGRAM, "monitor", exported, "--simulate", "--output-torque", "40", "--duration", "5", "--pace",
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
        port = mqtt_peer.free_port()
        monitor = self.start("--source", f"tcp://127.0.0.1:{port}")
        self.assertEqual(monitor.wait(60), 3)
        self.assertEqual(monitor.said(), f"error: cannot connect to 127.0.0.1:{port}: Connection refused\n")
        monitor = self.start("--source", "127.0.0.1:5000")
        self.assertEqual(monitor.wait(60), 2)
        self.assertEqual(monitor.said(), "error: address = 127.0.0.1:5000 (expected tcp://HOST:PORT, iio:URI/DEVICE as in "
                         "iio:ip:10.0.0.7/adxl355, or replay:FILE)\n")

    def broker(self, more=""):
        broker = mqtt_peer.Broker(more)
        broker.start()
        self.addCleanup(broker.close)
        plain = int(found.group(1)) if (found := re.search(r"listener (\d+)", more)) else broker.port
        return broker, self.listener(plain)

    def listener(self, port):
        def connect():
            try:
                return mqtt_peer.Client(port, "listener")
            except ConnectionRefusedError:  # a broker opens its listeners one after the other
                return None

        host = until(connect)
        self.addCleanup(host.close)
        host.subscribe("spBv1.0/lab/#")
        return host

    @staticmethod
    def messages_of(host):
        return [(topic.split("/")[2], mqtt_peer.decode(payload)) for topic, payload, _ in host.poll(0.05)]

    def data_of(self, host):
        return [payload for kind, payload in self.messages_of(host) if kind == "NDATA"]

    def test_what_waits_outlives_a_monitor_that_is_killed(self):
        """The broker dies, the monitor is killed twice, both come back: all windows that were shown arrive, in order."""
        broker, host = self.broker()
        path = self.settings(f"mqtt:\n  port: {broker.port}\n  group: lab\n  node: bench\n  outbox_file: outbox.db\n")
        replay = ("--replay", self.record, "--rounds", 1000, "--every", 10, "--pace", 200, "--settings", path)
        first = self.start(*replay)
        messages = []
        until(lambda: messages.extend(self.messages_of(host)) or sum(kind == "NDATA" for kind, _ in messages) >= 5)
        broker.kill()
        try:  # what it had sent on before it died
            while True:
                messages.extend(self.messages_of(host))
        except ConnectionError:
            pass
        shown = len(first.results())
        until(lambda: len(first.results()) >= shown + 20)
        first.kill()
        first.wait()
        second = self.start(*replay)
        until(lambda: len(second.results()) >= 20)
        second.kill()
        second.wait()
        self.assertRegex(second.said(), r"mqtt: \d+ windows of an earlier run wait in .*/outbox.db")
        broker.start()
        host = self.listener(broker.port)
        third = self.start("--replay", self.record, "--pace", "max", "--settings", path, "--linger", 30)
        self.assertEqual(third.wait(60), 0, third.said())
        until(lambda: messages.extend(self.messages_of(host)) or messages[-1][0] == "NDEATH")
        data = [payload["metrics"] for kind, payload in messages if kind == "NDATA"]
        # A monitor that is held up says that its values are stale: of no window.
        data = [metrics for metrics in data if metrics["Window"]["value"] is not None]
        numbers = [metrics["Window"]["value"] for metrics in data]
        self.assertEqual(sorted(set(numbers)), list(range(1, len(set(numbers)) + 1)), "a window is lost")
        news = [number for place, number in enumerate(numbers) if number not in numbers[:place]]
        self.assertEqual(news, sorted(news), "a window arrived before an earlier one")
        self.assertEqual(third.results()[-1]["window"], news[-1])
        arrived = dict(zip(numbers, data))
        for result in first.results() + second.results() + third.results():
            metrics = arrived[result["window"]]
            self.assertEqual(metrics["k2_Nm_per_rad/Value"]["value"], result["values"]["k2_Nm_per_rad"]["value"])
        # Again came at most what was under way as the broker died.
        again = [metrics for place, metrics in enumerate(data) if numbers[place] in numbers[:place]]
        self.assertLessEqual(len(again), 20)
        self.assertTrue(all(metrics["Window"]["historical"] for metrics in again))
        births = [payload["metrics"]["bdSeq"]["value"] for kind, payload in messages if kind == "NBIRTH"]
        self.assertEqual(len(set(births)), len(births), "two connections had one birth-death number")
        print(f"{len(news)} windows, {len(again)} of them twice", file=sys.stderr)

    def test_what_waits_is_not_sent_for_another_predictor(self):
        path = self.settings(f"mqtt:\n  port: {mqtt_peer.free_port()}\n  group: lab\n  node: bench\n"
                             "  outbox_file: other.db\n")
        replay = ("--replay", self.record, "--pace", "max", "--settings", path, "--linger", 0)
        monitor = self.start(*replay)
        self.assertEqual(monitor.wait(60), 0)
        self.assertIn(f"mqtt: 1 windows were not delivered and wait in {FOLDER / 'other.db'} for the next start",
                      monitor.said())
        other = FOLDER / "other_exported"
        for command in (["train", self.campaign, "--out", FOLDER / "other_predictor", "--epochs", "5", "--outputs",
                         "k2_Nm_per_rad"], ["export", FOLDER / "other_predictor", "--out", other]):
            subprocess.run([PROGRAM, *map(str, command)], check=True, capture_output=True)
        done = subprocess.run([PROGRAM, "monitor", str(other), *map(str, replay)], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn(f"{FOLDER / 'other.db'}: error: of the 1 windows that wait, number 1 is another predictor's (expected "
                      "the predictor whose results they are, or another outbox_file)\n", done.stderr)

    def tls(self, files, **names):
        """(broker, host, settings) with a listener for TLS that asks for certificates, and a plain one for the host."""
        plain = mqtt_peer.free_port()
        broker, host = self.broker(f"user root\ncafile {files / 'ca.pem'}\ncertfile {files / names.get('broker', 'broker')}.pem\n"
                                   f"keyfile {files / names.get('broker', 'broker')}.key\n"
                                   f"require_certificate true\nlistener {plain} 127.0.0.1\n")
        own = names.get("own", "monitor")
        lines = f"      certificate_file: {files / own}.pem\n      key_file: {files / own}.key\n" if own else ""
        path = self.settings(f"mqtt:\n    host: {names.get('host', '127.0.0.1')}\n    port: {broker.port}\n    group: lab\n"
                             f"    node: bench\n    tls:\n      ca_file: {files / names.get('ca', 'ca')}.pem\n{lines}")
        return broker, host, path

    def test_a_connection_is_encrypted_and_both_ends_are_known(self):
        files = test_certificates.make(FOLDER / "certificates")
        _, host, path = self.tls(files)
        monitor = self.start("--replay", self.record, "--pace", "max", "--settings", path, "--linger", 30)
        self.assertEqual(monitor.wait(60), 0, monitor.said())
        messages = []
        until(lambda: messages.extend(self.messages_of(host)) or any(kind == "NDATA" for kind, _ in messages))
        value = next(payload for kind, payload in messages if kind == "NDATA")["metrics"]["k2_Nm_per_rad/Value"]["value"]
        self.assertEqual(value, self.predicted()["k2_Nm_per_rad"]["value"])

    def test_a_certificate_that_is_gone_for_a_while_ends_nothing(self):
        files = test_certificates.make(FOLDER / "exchanged_certificates")
        broker, host, path = self.tls(files)
        monitor = self.start("--replay", self.record, "--rounds", 1000, "--every", 10, "--pace", 200, "--settings", path)
        until(lambda: self.data_of(host))
        (files / "monitor.pem").rename(files / "aside.pem")
        broker.kill()
        until(lambda: "monitor.pem: error: cannot be used for TLS" in monitor.said() or monitor.poll() is not None)
        self.assertIsNone(monitor.poll(), monitor.said())
        (files / "aside.pem").rename(files / "monitor.pem")
        births = monitor.said().count("published the birth")
        broker.start()
        until(lambda: monitor.said().count("published the birth") > births)

    def test_a_certificate_that_is_wrong_is_told_in_words(self):
        files = test_certificates.make(FOLDER / "wrong_certificates")
        signer = rf"signed by {files}/\w+\.pem\)"
        for names, words in (
                (dict(ca="other_ca"), rf"the broker's certificate is not accepted: .*certificate.* \(expected .* {signer}"),
                (dict(broker="expired"), rf"the broker's certificate is not accepted: certificate has expired \(expected .* {signer}"),
                (dict(broker="elsewhere"), r"the broker's certificate is not for 127.0.0.1 \(expected that name in it\)"),
                # Its objection is lost where the connection is gone before it is read.
                (dict(own=""), r"the broker (refuses the connection: certificate required|closed the connection without an "
                               r"answer) \(expected certificate_file to be one that it accepts\)")):
            with self.subTest(names):
                _, _, path = self.tls(files, **names)
                monitor = self.start("--replay", self.record, "--rounds", 1000, "--settings", path)
                found = until(lambda: re.search(r"mqtt: no connection to \S+ port \d+: (.*); \d+ windows wait", monitor.said()))
                self.assertRegex(found.group(1), words)
                monitor.send_signal(signal.SIGINT)
                self.assertEqual(monitor.wait(20), 130)
        for names, words in (
                (dict(own="expired"), f"{files}/expired.pem: error: the certificate expired at 2020-01-02 00:00 UTC (expected "
                                      "one that is valid now)\n"),
                (dict(ca="future"), f"{files}/future.pem: error: the certificate is not valid before 2049-01-01 00:00 UTC "
                                    "(expected one that is valid now, and a clock that is right)\n")):
            with self.subTest(names):
                _, _, path = self.tls(files, **names)
                monitor = self.start("--replay", self.record, "--settings", path)
                self.assertEqual(monitor.wait(60), 2)
                self.assertTrue(monitor.said().endswith(words), monitor.said())
        (files / "monitor.key").write_bytes((files / "broker.key").read_bytes())
        _, _, path = self.tls(files)
        monitor = self.start("--replay", self.record, "--settings", path)
        self.assertEqual(monitor.wait(60), 2)
        self.assertTrue(monitor.said().endswith(f"{files}/monitor.key: error: is not the key of {files}/monitor.pem (expected "
                                                "the key that belongs to it)\n"), monitor.said())

    def test_a_password_need_not_be_in_the_settings(self):
        words = FOLDER / "broker.users"
        subprocess.run(["mosquitto_passwd", "-b", "-c", str(words), "monitor", "open sesame"], check=True)
        words.chmod(0o644)
        plain = mqtt_peer.free_port()
        broker, host = self.broker(f"user root\nper_listener_settings true\nallow_anonymous false\npassword_file {words}\n"
                                   f"listener {plain} 127.0.0.1\nallow_anonymous true\n")
        path = self.settings(f"mqtt:\n  port: {broker.port}\n  group: lab\n  node: bench\n  user: monitor\n"
                             "  password_variable: BROKER_PASSWORD\n")
        replay = ("--replay", self.record, "--settings", path, "--pace", "max")
        monitor = self.start(*replay, "--linger", 30, environment={"BROKER_PASSWORD": "open sesame"})
        self.assertEqual(monitor.wait(60), 0, monitor.said())
        until(lambda: self.data_of(host))
        monitor = self.start(*replay, "--linger", 1, environment={"BROKER_PASSWORD": "close sesame"})
        monitor.wait(60)
        self.assertIn("Connection Refused: not authorised.", monitor.said())
        self.assertNotIn("sesame", monitor.said())


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    with tempfile.TemporaryDirectory() as folder:
        FOLDER = pathlib.Path(folder)
        unittest.main()
