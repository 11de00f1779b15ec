#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Passwords, tokens, keys and sessions that the program is given or makes: they are in no file that it writes, in no word that it
says, in no command line, and in the environment of no process that it starts; and no crash leaves them on the disk.

usage: secrets_test.py PROGRAM     exit code 77: skipped, a peer is not there"""
import os
import pathlib
import re
import resource
import secrets
import signal
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "peers"))
from needed import peers  # noqa: E402

with peers("/usr/sbin/mosquitto", "/usr/bin/openssl"):
    import exported_campaign
    import live_page
    import mqtt_peer
    import notice_servers
    import test_certificates
    import told_secrets
    from waiting import until


class Secrets(live_page.RunningCampaign):
    def setUp(self):
        super().setUp()
        self.home = self.folder.parent
        self.given = self.home / "given"  # holds secrets: what the user keeps
        self.said = self.home / "said"
        for folder in self.given, self.said:
            folder.mkdir()
        self.secrets, self.knows = {}, set()
        most = resource.getrlimit(resource.RLIMIT_CORE)[1]
        resource.setrlimit(resource.RLIMIT_CORE, (most, most))
        self.processes = told_secrets.Processes(live_page.PROGRAM)
        self.addCleanup(self.processes.end)

    def new(self, name):
        self.secrets[name] = f"open-sesame/{secrets.token_hex(12)}"
        return self.secrets[name]

    def file_of(self, name):
        """A file of the user's with a new secret in it."""
        file = self.given / name
        file.write_text(self.new(name) + "\n")
        return file

    def key_of(self, file):
        """From now on a key is a secret, by a line of it."""
        self.secrets[file.name] = file.read_text().splitlines()[3]
        return file

    def start(self, *words, code=None, **more):
        """A process whose words are kept; with a code, until it has ended with that."""
        with open(self.said / f"{len(list(self.said.iterdir()))}-{words[0]}.txt", "w") as log:
            process = subprocess.Popen([live_page.PROGRAM, *map(str, words)], stdout=log, stderr=log, cwd=self.said, **more)
        process.said = pathlib.Path(log.name).read_text
        self.addCleanup(live_page.ended, process)
        if code is not None:
            self.assertEqual(process.wait(live_page.PATIENCE_s), code, process.said())
        return process

    def nothing_is_told(self, *commands):
        """Of all that is secret; these commands were seen at work."""
        self.processes.end()
        self.assertLessEqual(set(commands), self.processes.commands())
        self.assertEqual(self.processes.found(self.secrets, self.knows), set())
        self.assertEqual(told_secrets.found_in([self.folder, self.said], self.secrets), set())
        kept = {name for name, _ in told_secrets.found_in([self.given], self.secrets)}
        self.assertLessEqual({name for name in self.secrets if (self.given / name).exists()}, kept, "the search finds nothing")

    def add_user(self, users):
        process = self.start("users", users, "add", "A. Meier", "--role", "operator", stdin=subprocess.PIPE, text=True)
        until(lambda: not told_secrets.leaves_core(process.pid))
        process.communicate(self.new("password of a user") + "\n")
        self.assertEqual(process.returncode, 0, process.said())

    def test_of_the_page_are_told_nowhere(self):
        certificates = test_certificates.make(self.given / "certificates")
        users = self.home / "said" / "users.yaml"  # holds hashes
        self.add_user(users)
        run = self.start("run", live_page.SMALL, "--out", self.folder, "--pace", "20", "--serve", "--port", "0", "--users", users,
                         "--tls", certificates / "broker.pem", self.key_of(certificates / "broker.key"))
        port, process = map(int, until(lambda: re.search(r"page: https://127.0.0.1:(\d+)/, in process (\d+)", run.said())).groups())
        self.addCleanup(os.kill, process, signal.SIGKILL)
        self.assertFalse(told_secrets.leaves_core(process))
        self.assertTrue(told_secrets.leaves_core(run.pid) or resource.getrlimit(resource.RLIMIT_CORE)[1] == 0)
        page, other = (live_page.Page(port, None, "https") for _ in range(2))
        for one in page, other:
            one.trust(certificates / "ca.pem")
        self.assertEqual(page.log_in("A. Meier", self.secrets["password of a user"])[0], 200)
        self.secrets["session"] = page.cookie["Cookie"].partition("=")[2]
        self.assertEqual(other.log_in("A. Meier", self.new("wrong password"))[0], 401)
        # Somebody who types it in the wrong place.
        until(lambda: other.log_in(self.new("password as a name").replace("/", "-"), "x")[0] == 401)
        state = page.state()
        self.secrets["token"] = state["token"].partition(".")[2]
        self.assertEqual(page.act("note", state["run"], state["token"], text="grease changed")[0], 200)
        self.assertEqual(page.do("pause", text="lunch")[0], 200)
        self.assertEqual(run.wait(live_page.PATIENCE_s), 130)
        until(lambda: page.state()["state"] == "stopped")
        self.assertEqual(page.do("resume")[0], 200)
        until(lambda: page.state()["state"] == "running")
        self.assertEqual(page.do("stop_now")[0], 200)
        until(lambda: page.state()["state"] == "stopped")
        for words in ("status", self.folder, "--json"), ("alarms", self.folder, "--json"), ("verify", self.folder):
            self.start(*words, code=0)
        self.start("serve", self.folder, "--users", users, "--tls", certificates / "monitor.pem", certificates / "broker.key", code=2)
        self.nothing_is_told("users", "run", "serve", "verify")

    def test_of_notices_are_told_nowhere(self):
        schedule = self.home / "trips.yaml"
        schedule.write_text(live_page.SMALL.read_text().replace("twist: 30 arcmin", "twist: 5 arcmin"))
        self.start("run", schedule, "--out", self.folder, code=1)
        certificates = test_certificates.make(self.given / "certificates")
        mail, broker, hook = (self.file_of(name) for name in ("mail", "broker", "hook"))
        mailbox = notice_servers.Mailbox(certificates=certificates, user="bench", password=self.secrets["mail"])
        webhook = notice_servers.Webhook()
        for server in mailbox, webhook:
            self.addCleanup(server.close)
        users = self.given / "users"
        subprocess.run(["mosquitto_passwd", "-b", "-c", str(users), "bench", self.secrets["broker"]], check=True)
        mosquitto = mqtt_peer.Broker(f"user root\nallow_anonymous false\npassword_file {users}\n")
        mosquitto.start()
        self.addCleanup(mosquitto.close)
        hook.write_text(f"http://127.0.0.1:{webhook.port}/{self.secrets['hook']}\n")
        settings = self.given / "notices.yaml"

        def notices(server="smtp://127.0.0.1:%d" % mailbox.port):
            settings.write_text(f"""notices: 1
delay: 0 s
channels:
  mail: {{server: "{server}", from: a@b, to: a@b, user: bench, password_file: {mail}, ca_file: {certificates}/ca.pem}}
  webhook: {{url_file: {hook}}}
  mqtt: {{broker: "mqtt://127.0.0.1:{mosquitto.port}", user: bench, password_file: {broker}}}
""")
            return "watch", self.folder, "--notices", settings

        test = self.start(*notices(), "--test", code=0)
        self.assertEqual(test.said().count(": taken\n"), 3)
        self.assertEqual((len(mailbox.mails), webhook.notices[0]["path"]), (1, f"/{self.secrets['hook']}"))
        watch = self.start(*notices())
        until(lambda: watch.said().count(": sent: ") == 3)
        self.assertFalse(told_secrets.leaves_core(watch.pid))
        watch.send_signal(signal.SIGINT)
        self.assertEqual(watch.wait(live_page.PATIENCE_s), 0)
        mail.write_text(self.new("mail") + "\n")  # another one than the server's
        broker.write_text(self.new("broker") + "\n")
        hook.write_text(f"http://127.0.0.1:{mqtt_peer.free_port()}/{self.secrets['hook']}\n")
        test = self.start(*notices(), "--test", code=3)
        self.assertEqual(test.said().count(": NOT taken: "), 3)
        self.start(*notices(f"smtp://bench:{self.secrets['mail']}@127.0.0.1"), "--test", code=2)
        self.nothing_is_told("watch")

    def test_of_a_monitor_are_told_nowhere(self):
        _, exported = exported_campaign.make(live_page.PROGRAM, self.home)
        self.folder = self.said
        file = self.file_of("broker")
        users = self.given / "users"
        subprocess.run(["mosquitto_passwd", "-b", "-c", str(users), "bench", self.secrets["broker"]], check=True)
        mosquitto = mqtt_peer.Broker(f"user root\nallow_anonymous false\npassword_file {users}\n")
        mosquitto.start()
        self.addCleanup(mosquitto.close)
        settings = self.given / "monitor.yaml"

        def monitor(*lines):
            settings.write_text("\n  ".join(("monitor: 1\nmqtt:", f"port: {mosquitto.port}", "node: bench", "user: bench",
                                            f"outbox_file: {self.said}/outbox.db", *lines)) + "\n")
            return "monitor", exported, "--simulate", "--pace", 4, "--duration", "1e6", "--json", "--settings", settings

        for line, environment in ((f"password_file: {file}", {}), (f"password: {self.secrets['broker']}", {}),
                                  ("password_variable: BROKER_PASSWORD", {"BROKER_PASSWORD": self.secrets["broker"]})):
            running = self.start(*monitor(line), env=os.environ | environment)
            self.knows |= {running.pid} if environment else set()
            until(lambda: "mqtt: published the birth" in running.said())
            self.assertFalse(told_secrets.leaves_core(running.pid))
            running.send_signal(signal.SIGINT)
            self.assertEqual(running.wait(live_page.PATIENCE_s), 130)
        refused = self.start(*monitor(f"password: {self.new('wrong password')}"))
        until(lambda: "not authorised" in refused.said())
        certificates = test_certificates.make(self.given / "certificates")
        key = self.key_of(certificates / "broker.key")
        for line in (f"host: bench:{self.secrets['broker']}@127.0.0.1", f"password: |\n    {self.secrets['broker']}",
                     f"tls: {{ca_file: {certificates}/ca.pem, certificate_file: {certificates}/monitor.pem, key_file: {key}}}",
                     f"tls: {{ca_file: {key}}}"):
            self.start(*monitor(line), code=2)
        self.nothing_is_told("monitor")


if __name__ == "__main__":
    live_page.main()
