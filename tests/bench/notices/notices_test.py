#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Word of a campaign to whoever is not there: `strainwave watch` against a mail server, a web server and a broker.

usage: notices_test.py PROGRAM"""
import contextlib
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "peers"))
from free_port import free_port  # noqa: E402
from needed import peers  # noqa: E402

with peers("/usr/sbin/mosquitto", "/usr/bin/openssl"):
    import live_page
    import mqtt_peer
    import notice_servers
    import test_certificates
    from waiting import until

PROGRAM = ""
FOLDER = pathlib.Path()
TOPIC = "lab/notices"
PASSWORD = "open sesame 93"


def run(*words, check=True):
    return subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, check=check)


class NoticesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        """One campaign that its blank test has tripped, with the alarm twist_limit."""
        cls.tripped = FOLDER / "tripped"
        if cls.tripped.exists():
            return
        schedule = FOLDER / "trips.yaml"
        schedule.write_text(live_page.SMALL.read_text().replace("twist: 30 arcmin", "twist: 5 arcmin"))
        assert run("run", schedule, "--out", cls.tripped, check=False).returncode == 1

    def setUp(self):
        self.stack = contextlib.ExitStack()
        self.addCleanup(self.stack.close)
        self.home = pathlib.Path(self.stack.enter_context(tempfile.TemporaryDirectory(dir=FOLDER)))
        self.folder = self.home / "first"

    def closing(self, server):
        self.addCleanup(server.close)
        return server

    def settings(self, channels, more="delay: 0 s\n"):
        file = self.home / "notices.yaml"
        file.write_text("notices: 1\nchannels:\n" + "".join(f"  {line}\n" for line in channels) + more)
        return file

    @staticmethod
    def mail_to(port, more=""):
        return f'mail: {{server: "smtp://127.0.0.1:{port}", from: bench@lab.example, to: a@lab.example{more}}}'

    @staticmethod
    def post_to(port):
        return f'webhook: {{url: "http://127.0.0.1:{port}/hook"}}'

    def copy_tripped(self):
        shutil.copytree(self.tripped, self.folder)

    def begin(self, *more):
        return self.stack.enter_context(live_page.campaign(PROGRAM, self.folder, "20", *more))

    def once(self, settings, code=0):
        done = run("watch", self.folder, "--notices", settings, "--once", check=False)
        self.assertEqual((done.returncode, done.stdout), (code, ""), done.stderr)
        return done.stderr

    def watch(self, settings):
        """One that runs; `said` reads what it has said so far."""
        log = self.home / f"watch-{len(list(self.home.glob('watch-*')))}.txt"
        with open(log, "w") as words:
            process = subprocess.Popen([PROGRAM, "watch", self.folder, "--notices", settings], stderr=words)
        self.addCleanup(live_page.ended, process)
        process.said = log.read_text
        until(lambda: ": watched (" in process.said())
        return process

    def kept(self):
        with contextlib.suppress(FileNotFoundError):
            return json.loads((self.folder / "notices.json").read_text())


class TheChannels(NoticesTest):
    def test_all_get_what_is_due_once(self):
        self.copy_tripped()
        mailbox, webhook = self.closing(notice_servers.Mailbox()), self.closing(notice_servers.Webhook())
        broker, published = self.stack.enter_context(notice_servers.listener(TOPIC))
        settings = self.settings([self.mail_to(mailbox.port), self.post_to(webhook.port),
                                  f'mqtt: {{broker: "mqtt://127.0.0.1:{broker.port}", topic: {TOPIC}}}'])
        said = self.once(settings)
        for channel in "mail", "webhook", "mqtt":
            self.assertIn(f" {channel}: sent: strainwave first: fault: ", said)
        notice = until(published)[0]
        self.assertEqual((notice["kind"], notice["priority"], notice["state"], notice["campaign"], notice["specimen"]),
                         ("fault", "high", "faulted", "first", "TEST-0001"))
        self.assertEqual([(alarm["number"], alarm["code"]) for alarm in notice["alarms"]], [(1, "twist_limit")])
        self.assertEqual(webhook.notices, [{"type": "application/json", "path": "/hook", **notice}])
        (mail,) = mailbox.mails
        self.assertEqual((mail["from"], mail["to"], mail["subject"], mail["text"]),
                         ("bench@lab.example", ["a@lab.example"], notice["subject"], notice["text"]))
        self.assertEqual(mail["id"], f"<{notice['id']}@lab.example>")
        self.assertIn(f"strainwave alarms {self.folder} acknowledge 1 --by NAME", mail["text"])
        self.assertEqual(self.once(settings), "")
        self.assertEqual((len(mailbox.mails), len(webhook.notices), len(published())), (1, 1, 1))

    def test_are_tried_by_test(self):
        self.copy_tripped()
        mailbox, dead = self.closing(notice_servers.Mailbox()), free_port()
        settings = self.settings([self.mail_to(mailbox.port), self.post_to(dead)], "")
        done = run("watch", self.folder, "--notices", settings, "--test", check=False)
        self.assertEqual(done.returncode, 3)
        self.assertRegex(done.stdout, r"^mail to a@lab\.example: taken\nwebhook to its URL: NOT taken: Failed to connect .*\n$")
        self.assertEqual(mailbox.mails[0]["subject"], "strainwave first: test")
        self.assertIsNone(self.kept())
        self.assertEqual(run("watch", self.folder, "--notices", self.settings([self.mail_to(mailbox.port)]), "--test").stdout,
                         "mail to a@lab.example: taken\n")

    def test_print_what_is_due_in_a_dry_run(self):
        self.copy_tripped()
        done = run("watch", self.folder, "--notices", self.settings([self.post_to(1)]), "--dry-run")
        self.assertTrue(done.stdout.startswith("strainwave first: fault: "), done.stdout)
        self.assertTrue(done.stdout.endswith(f"{self.folder}: faulted; 1 notice(s) due\n"), done.stdout)
        self.assertIsNone(self.kept())

    def test_that_are_dead_hold_up_no_other_and_are_tried_again(self):
        self.copy_tripped()
        port = free_port()
        webhook, silent = self.closing(notice_servers.Webhook()), self.closing(notice_servers.Silent())
        settings = self.settings([self.mail_to(port), self.post_to(webhook.port),
                                  f'mqtt: {{broker: "mqtt://127.0.0.1:{silent.port}"}}'])
        watch = self.watch(settings)
        until(lambda: webhook.kinds() == ["fault"])
        until(lambda: " mail: not sent, tried again later: " in watch.said())
        mail_state = until(lambda: (kept := self.kept()) and kept["channels"][0]["failures"] and kept["channels"][0])
        self.assertEqual(mail_state["name"], "mail")
        self.assertIn(f"port {port}", mail_state["trouble"])
        until(lambda: self.kept()["waiting"][0]["channels"] == ["mail", "mqtt"])
        mailbox = self.closing(notice_servers.Mailbox(port))
        until(lambda: mailbox.mails)
        until(lambda: self.kept()["channels"][0]["trouble"] == "")
        self.assertEqual(webhook.kinds(), ["fault"])

    def test_that_refuse_are_told_of(self):
        self.copy_tripped()
        webhook = self.closing(notice_servers.Webhook())
        webhook.status = 503
        settings = self.settings([self.post_to(webhook.port)])
        self.assertIn("webhook: not sent, tried again later: the server answers 503 (expected 200 to 299)",
                      self.once(settings, 3))
        self.assertEqual(self.once(settings, 3), "", "left alone for a while")
        self.assertEqual(webhook.kinds(), ["fault"])

    def test_of_mail_use_tls_and_a_password_that_is_shown_nowhere(self):
        self.copy_tripped()
        certificates = test_certificates.make(self.home / "certificates")
        (self.home / "secret").write_text(PASSWORD + "\n")
        mailbox = self.closing(notice_servers.Mailbox(certificates=certificates, user="bench", password=PASSWORD))
        login = f", user: bench, password_file: secret, ca_file: {certificates}/ca.pem"
        settings = self.settings([self.mail_to(mailbox.port, login)])
        said = self.once(settings)
        self.assertEqual((mailbox.logins, len(mailbox.mails)), ([("bench", PASSWORD)], 1))
        (self.home / "secret").write_text("wrong " + PASSWORD)
        test = run("watch", self.folder, "--notices", settings, "--test", check=False)
        self.assertRegex(test.stdout, "^mail to a@lab.example: NOT taken: Login denied\n$")
        self.assertEqual(len(mailbox.mails), 1)
        shown = said + test.stdout + test.stderr + (self.folder / "notices.json").read_text()
        self.assertNotIn(PASSWORD, shown)
        # Without encryption, or with a certificate of somebody else, nothing of it leaves the machine.
        logins = list(mailbox.logins)
        plain = self.closing(notice_servers.Mailbox())
        for port, ca in (plain.port, "ca"), (mailbox.port, "other_ca"):
            settings = self.settings([self.mail_to(port, f", user: bench, password_file: secret, ca_file: {certificates}/{ca}.pem")])
            test = run("watch", self.folder, "--notices", settings, "--test", check=False)
            self.assertEqual(test.returncode, 3, test.stdout)
        self.assertEqual((mailbox.logins, plain.mails), (logins, []))

    def test_of_mail_reach_all_but_those_whose_address_is_wrong(self):
        self.copy_tripped()
        mailbox = self.closing(notice_servers.Mailbox(refused=["gone@lab.example"]))
        settings = self.settings([f'mail: {{server: "smtp://127.0.0.1:{mailbox.port}", from: bench@lab.example, '
                                  'to: [gone@lab.example, a@lab.example]}'])
        self.once(settings)
        self.assertEqual(mailbox.mails[0]["to"], ["a@lab.example"])

    def test_of_mqtt_use_tls(self):
        self.copy_tripped()
        certificates = test_certificates.make(self.home / "certificates")
        port = free_port()
        broker = self.closing(mqtt_peer.Broker(f"listener {port} 127.0.0.1\ncafile {certificates}/ca.pem\n"
                                               f"certfile {certificates}/broker.pem\nkeyfile {certificates}/broker.key\nuser root"))
        broker.start()
        for ca, code in ("ca", 0), ("other_ca", 3):
            settings = self.settings([f'mqtt: {{broker: "mqtts://127.0.0.1:{port}", ca_file: {certificates}/{ca}.pem}}'])

            def test():
                return run("watch", self.folder, "--notices", settings, "--test", check=False).returncode == code

            until(test)  # a broker opens its listeners one after the other


class Alarms(NoticesTest):
    def setUp(self):
        super().setUp()
        self.copy_tripped()
        self.mailbox = self.closing(notice_servers.Mailbox())

    def settings_of(self, more):
        return self.settings([self.mail_to(self.mailbox.port)], more)

    def act(self, verb):
        run("alarms", self.folder, verb, 1, "--by", "A. Meier")

    def test_are_not_told_of_within_the_delay_nor_once_acknowledged(self):
        self.once(self.settings_of("delay: 1 h\n"))
        self.assertEqual(self.mailbox.mails, [])
        self.act("acknowledge")
        self.once(self.settings_of("delay: 0 s\n"))
        self.assertEqual(self.mailbox.mails, [])

    def test_are_not_told_of_while_shelved(self):
        run("alarms", self.folder, "shelve", 1, "--for", "1h", "--by", "A. Meier")
        self.once(self.settings_of("delay: 0 s\n"))
        self.assertEqual(self.mailbox.mails, [])
        self.act("unshelve")
        self.once(self.settings_of("delay: 0 s\n"))
        self.assertEqual(len(self.mailbox.mails), 1)

    def test_are_escalated_and_followed_up(self):
        second = "escalate_to: [b@lab.example]\nescalate_after: "
        self.once(self.settings_of(f"delay: 0 s\n{second}1 h\n"))
        self.once(self.settings_of(f"delay: 0 s\n{second}1 us\n"))
        self.assertEqual([mail["to"] for mail in self.mailbox.mails], [["a@lab.example"], ["b@lab.example"]])
        self.assertEqual(self.mailbox.subjects()[1], "alarm 1 (high) twist_limit is not acknowledged")
        self.act("acknowledge")
        self.once(self.settings_of(f"delay: 0 s\n{second}1 us\n"))
        self.assertEqual(len(self.mailbox.mails), 2, "not cleared yet: it latches")
        # The next run resets the interlock, and trips again.
        run("run", FOLDER / "trips.yaml", "--out", self.folder, "--resume", check=False)
        self.act("confirm")
        self.once(self.settings_of(f"delay: 1 h\n{second}1 h\n"))
        self.assertEqual(self.mailbox.subjects()[2:], ["alarm 1 (high) twist_limit has cleared"])
        self.assertEqual(self.mailbox.mails[2]["to"], ["a@lab.example", "b@lab.example"])

    def test_make_no_header_whatever_they_say(self):
        self.folder = self.folder.rename(self.home / "x\r\nBcc: all@lab.example\r\n\r\nbody")
        self.once(self.settings_of("delay: 0 s\n"))
        (mail,) = self.mailbox.mails
        self.assertEqual(mail["to"], ["a@lab.example"])
        self.assertEqual(mail["headers"], ["Date", "From", "To", "Subject", "Message-ID", "Auto-Submitted", "MIME-Version",
                                           "Content-Type", "Content-Transfer-Encoding"])
        self.assertTrue(mail["subject"].startswith(r"strainwave x\x0d\nBcc: all@lab.example\x0d\n\x0d\nbody: fault: "), mail["subject"])


class Silence(NoticesTest):
    def setUp(self):
        super().setUp()
        self.webhook = self.closing(notice_servers.Webhook())
        self.quick = self.settings([self.post_to(self.webhook.port)], "delay: 0 s\nsilence_after: 1 h\n")

    def test_is_told_of_a_killed_run_and_that_it_goes_on(self):
        campaign = self.begin()
        first = self.watch(self.quick)
        campaign.kill()
        campaign.wait()
        until(lambda: self.webhook.kinds() == ["silence"])
        self.assertEqual(self.webhook.notices[0]["state"], "interrupted")
        until(lambda: not self.kept()["waiting"])
        # A watch that is killed itself tells nothing twice.
        first.kill()
        first.wait()
        self.once(self.quick)
        self.assertEqual(self.webhook.kinds(), ["silence"])
        self.watch(self.quick)
        self.begin("--resume")
        until(lambda: self.webhook.kinds() == ["silence", "spoke_again"])

    def test_is_told_of_a_frozen_run(self):
        campaign = self.begin()
        self.watch(self.settings([self.post_to(self.webhook.port)], "silence_after: 10 s\n"))
        campaign.send_signal(signal.SIGSTOP)
        until(lambda: self.webhook.kinds() == ["silence"])
        notice = self.webhook.notices[0]
        self.assertEqual(notice["state"], "running")
        self.assertIn(f"process {campaign.pid} has the campaign and has given no sign of life for ", notice["text"])
        campaign.send_signal(signal.SIGCONT)
        until(lambda: self.webhook.kinds() == ["silence", "spoke_again"])

    def test_is_seen_by_one_look_of_a_timer(self):
        campaign = self.begin()
        self.once(self.settings([self.post_to(self.webhook.port)], "silence_after: 1 h\n"))
        self.assertEqual(self.webhook.kinds(), [])
        campaign.kill()
        campaign.wait()
        self.once(self.settings([self.post_to(self.webhook.port)], "silence_after: 1 h\n"))
        self.assertEqual(self.webhook.kinds(), ["silence"])

    def test_is_none_when_a_run_is_stopped_or_complete(self):
        campaign = self.begin()
        self.watch(self.quick)
        campaign.send_signal(signal.SIGINT)
        campaign.wait()
        until(lambda: self.webhook.kinds() == ["stopped"])
        run("run", live_page.SMALL, "--out", self.folder, "--resume")
        until(lambda: self.webhook.kinds() == ["stopped", "complete"])

    def test_is_told_of_a_folder_that_is_gone(self):
        self.copy_tripped()
        self.watch(self.settings([self.post_to(self.webhook.port)], "silence_after: 1 s\n"))
        until(self.kept)
        away = self.folder.with_name("away")
        self.folder.rename(away)
        until(lambda: self.webhook.kinds() == ["silence"])
        self.assertEqual(self.webhook.notices[0]["state"], "unreadable")
        away.rename(self.folder)
        until(lambda: self.webhook.kinds() == ["silence", "spoke_again"])


class TheCommand(NoticesTest):
    def said(self, *words):
        done = run("watch", *words, check=False)
        self.assertEqual(done.stdout, "")
        return done.returncode, done.stderr

    def test_says_what_is_wrong(self):
        settings = self.settings([self.post_to(1)])
        self.assertEqual(self.said(self.folder, "--notices", settings),
                         (2, f"{self.folder}: error: there is no such folder (expected that of a campaign, which strainwave run "
                             f"SCHEDULE --out {self.folder} makes)\n"))
        code, words = self.said(self.home, "--notices", settings)
        self.assertEqual((code, words), (2, f"{self.home}: error: not a campaign (expected a folder with schedule.yaml, bench.yaml "
                                            "and campaign.db)\n"))
        settings = self.settings(["web: {}"])
        code, words = self.said(self.home, "--notices", settings)
        self.assertEqual(code, 2)
        self.assertIn(f"{settings}:3:3: error: unknown key 'web'", words)

    def test_writes_nothing_into_the_campaign_but_its_own_file(self):
        self.copy_tripped()
        webhook = self.closing(notice_servers.Webhook())
        before = {file: file.read_bytes() for file in self.folder.rglob("*") if file.is_file()}
        self.once(self.settings([self.post_to(webhook.port)]))
        after = {file: file.read_bytes() for file in self.folder.rglob("*") if file.is_file()}
        self.assertEqual({file.name for file in after.keys() - before.keys()} - {"campaign.db-wal", "campaign.db-shm"},
                         {"notices.json", "notices.lock"})
        for file, content in before.items():
            if not file.name.endswith("-shm"):
                self.assertEqual(after[file], content, file)

    def test_is_one_a_campaign_and_ends_well_when_it_is_asked_to(self):
        self.copy_tripped()
        webhook = self.closing(notice_servers.Webhook())
        settings = self.settings([self.post_to(webhook.port)])
        watch = self.watch(settings)
        code, words = self.said(self.folder, "--notices", settings, "--once")
        self.assertEqual(code, 2)
        self.assertIn("another strainwave watch sends its notices already", words)
        watch.send_signal(signal.SIGINT)
        self.assertEqual(watch.wait(live_page.PATIENCE_s), 0)
        self.assertIsNone(re.search("error", watch.said()))


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    os.environ["no_proxy"] = "*"
    with tempfile.TemporaryDirectory() as scratch:
        FOLDER = pathlib.Path(scratch)
        unittest.main()
