#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What becomes of a monitor's results when the broker or its host is not there: a broker that is stopped, a monitor that is
killed, a host of Sparkplug 2.2, certificates that are wrong.

usage: monitor_broker_test.py PROGRAM     exit code 77: skipped, a peer is not there"""
import pathlib
import re
import signal
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "peers"))
import needed  # noqa: E402
import test_certificates  # noqa: E402
from free_port import free_port  # noqa: E402
from waiting import until  # noqa: E402

with needed.peers("/usr/sbin/mosquitto"):
    import monitor_fixture


class Broker(monitor_fixture.MonitorTest):
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
        host = self.listener(broker, broker.port)
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

    def test_a_primary_host_of_sparkplug_2_2_gets_its_data(self):
        broker, host = self.broker()
        host.publish("STATE/scada", b"ONLINE", retain=True)
        path = self.settings(f"mqtt:\n  port: {broker.port}\n  group: lab\n  node: bench\n  primary_host: scada\n")
        monitor = self.start("--replay", self.record, "--pace", "max", "--settings", path, "--linger", 30)
        self.assertEqual(monitor.wait(60), 0, monitor.said())
        kinds = []
        until(lambda: kinds.extend(kind for kind, _ in self.messages_of(host)) or "NDEATH" in kinds)
        self.assertEqual(kinds, ["NBIRTH", "NDATA", "NDEATH"])
        self.assertNotIn("waits for", monitor.said())

    def test_what_a_monitor_waits_for_is_told_and_why_windows_are_lost(self):
        broker, host = self.broker()
        path = self.settings(f"mqtt:\n  port: {broker.port}\n  group: lab\n  node: bench\n  primary_host: scada\n")
        monitor = self.start("--replay", self.record, "--rounds", 1000, "--every", 10, "--pace", 200, "--settings", path,
                             "--linger", 0)
        until(lambda: "mqtt: waits for the primary host scada: nothing is heard on spBv1.0/STATE/scada (Sparkplug 3.0) or "
                      "STATE/scada (2.2); nothing is sent meanwhile, " in monitor.said())
        host.publish("STATE/scada", b"hello")
        until(lambda: "scada: what is heard on STATE/scada is no state of a host; nothing is sent" in monitor.said())
        host.publish("STATE/scada", b"OFFLINE", retain=True)
        until(lambda: "scada: it says on STATE/scada that it is offline; nothing is sent" in monitor.said())
        until(lambda: monitor.results())  # a window that waits
        monitor.send_signal(signal.SIGINT)
        self.assertEqual(monitor.wait(20), 130)
        self.assertRegex(monitor.said().splitlines()[-1],
                         r"^mqtt: error: \d+ windows were not delivered and are lost: waits for the primary host scada: it says "
                         r"on STATE/scada that it is offline$")
        self.assertEqual(self.messages_of(host), [])

    def test_what_waits_is_not_sent_for_another_predictor(self):
        path = self.settings(f"mqtt:\n  port: {free_port()}\n  group: lab\n  node: bench\n"
                             "  outbox_file: other.db\n")
        replay = ("--replay", self.record, "--pace", "max", "--settings", path, "--linger", 0)
        monitor = self.start(*replay)
        self.assertEqual(monitor.wait(60), 0)
        self.assertIn(f"mqtt: 1 windows were not delivered and wait in {self.folder / 'other.db'} for the next start",
                      monitor.said())
        other = self.folder / "other_exported"
        for command in (["train", self.campaign, "--out", self.folder / "other_predictor", "--epochs", "5", "--outputs",
                         "k2_Nm_per_rad"], ["export", self.folder / "other_predictor", "--out", other, "--anyway"]):
            subprocess.run([self.program, *map(str, command)], check=True, capture_output=True)
        done = subprocess.run([self.program, "monitor", str(other), *map(str, replay)], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn(f"{self.folder / 'other.db'}: error: of the 1 windows that wait, number 1 is another predictor's (expected "
                      "the predictor whose results they are, or another outbox_file)\n", done.stderr)

    def tls(self, files, **names):
        """(broker, host, settings) with a listener for TLS that asks for certificates, and a plain one for the host."""
        plain = free_port()
        broker, host = self.broker(f"user root\ncafile {files / 'ca.pem'}\ncertfile {files / names.get('broker', 'broker')}.pem\n"
                                   f"keyfile {files / names.get('broker', 'broker')}.key\n"
                                   f"require_certificate true\nlistener {plain} 127.0.0.1\n")
        own = names.get("own", "monitor")
        lines = f"      certificate_file: {files / own}.pem\n      key_file: {files / own}.key\n" if own else ""
        path = self.settings(f"mqtt:\n    host: {names.get('host', '127.0.0.1')}\n    port: {broker.port}\n    group: lab\n"
                             f"    node: bench\n    tls:\n      ca_file: {files / names.get('ca', 'ca')}.pem\n{lines}")
        return broker, host, path

    def test_a_connection_is_encrypted_and_both_ends_are_known(self):
        files = test_certificates.make(self.folder / "certificates")
        _, host, path = self.tls(files)
        monitor = self.start("--replay", self.record, "--pace", "max", "--settings", path, "--linger", 30)
        self.assertEqual(monitor.wait(60), 0, monitor.said())
        messages = []
        until(lambda: messages.extend(self.messages_of(host)) or any(kind == "NDATA" for kind, _ in messages))
        value = next(payload for kind, payload in messages if kind == "NDATA")["metrics"]["k2_Nm_per_rad/Value"]["value"]
        self.assertEqual(value, self.predicted()["k2_Nm_per_rad"]["value"])

    def test_a_certificate_that_is_gone_for_a_while_ends_nothing(self):
        files = test_certificates.make(self.folder / "exchanged_certificates")
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
        files = test_certificates.make(self.folder / "wrong_certificates")
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
        words = self.folder / "broker.users"
        subprocess.run(["mosquitto_passwd", "-b", "-c", str(words), "monitor", "open sesame"], check=True)
        words.chmod(0o644)
        plain = free_port()
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
    monitor_fixture.main()
