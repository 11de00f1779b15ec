#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A campaign as a service: a person's order, what the service manager hears, and what goes on without a person.

usage: service_test.py PROGRAM"""
import json
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import unittest

import running_campaign
from running_campaign import SMALL, until

PROGRAM = ""
RULES = "operator_acknowledges: true"


class Manager:
    """The other end of sd_notify(3)."""

    def __init__(self, folder):
        self.path = folder / "notify"
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(str(self.path))
        self.socket.settimeout(60)

    def environment(self):
        return {**os.environ, "NOTIFY_SOCKET": str(self.path), "WATCHDOG_USEC": "200000"}

    def next(self, begins):
        while not (said := self.socket.recv(4096).decode()).startswith(begins):
            pass
        return said

    def close(self):
        self.socket.close()


class Service(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.out = self.folder / "first"
        self.schedule = self.folder / "schedule.yaml"
        self.write("operator_acknowledges: false\n  unattended: 2")

    def write(self, rules):
        self.schedule.write_text(SMALL.replace(RULES, rules))

    def run_it(self, *words, **environment):
        return subprocess.run([PROGRAM, *map(str, words)], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False,
                              env={**os.environ, **environment})

    def order(self, *words):
        return self.run_it("run", *words, "--out", self.out, "--by-service", "--pace", "20", SUDO_USER="A. Meier")

    def begin(self, manager):
        """As the unit does; under way when it returns."""
        process = subprocess.Popen([PROGRAM, "run", "--out", str(self.out), "--resume", "--unattended"], stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=manager.environment())
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        manager.next("READY=1")
        manager.next("STATUS=")
        return process

    def manager(self):
        manager = Manager(pathlib.Path(tempfile.mkdtemp(dir=self.folder)))
        self.addCleanup(manager.close)
        return manager

    def killed(self):
        """A run that is cut in a phase."""
        process = self.begin(self.manager())
        until(lambda: self.status()["phase"] != "none" or process.poll() is not None)
        process.kill()
        self.assertEqual(process.wait(), -signal.SIGKILL)

    def status(self):
        return json.loads(self.run_it("status", self.out, "--json").stdout)

    def refusal(self):
        done = self.run_it("run", "--out", self.out, "--resume", "--unattended")
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        end = (f" (expected one at the bench to order it, within 10 minutes: strainwave run --out {self.out} --resume "
               "--by-service)\n")
        self.assertTrue(done.stderr.endswith(end), done.stderr)
        return done.stderr.removesuffix(end).removeprefix(f"{self.out}: error: the campaign does not go on without a person: ")

    def test_begins_what_a_person_has_ordered_and_the_manager_hears_of_it(self):
        ordered = self.order(self.schedule)
        self.assertEqual((ordered.returncode, ordered.stdout), (0, ""))
        self.assertEqual(ordered.stderr.splitlines()[-1],
                         f"{self.out}: a service may run it, if it begins within ten minutes: strainwave run --out {self.out} "
                         "--resume --unattended")
        manager = self.manager()
        process = self.begin(manager)
        for _ in range(3):
            manager.next("WATCHDOG=1")
        self.assertRegex(manager.next("STATUS="), r"^STATUS=\d+ %, cycle \d of 3, [a-z_]+$")
        process.terminate()
        self.assertEqual(process.wait(60), 130)
        self.assertIn("A. Meier has ordered --by-service, and with it that shafts may move",
                      [event["text"] for event in self.events("acknowledged")])

    def events(self, code):
        text = "SELECT json_group_array(json_object('text', text, 'severity', severity)) FROM events WHERE code = "
        return json.loads(subprocess.run(["sqlite3", "-readonly", self.out / "campaign.db", f"{text}'{code}'"], check=True,
                                         capture_output=True, text=True).stdout)

    def test_goes_on_after_a_cut_as_often_as_the_schedule_says(self):
        self.assertEqual(self.order(self.schedule).returncode, 0)
        for restarts in range(3):
            self.killed()
            self.assertEqual((self.status()["unattended_restarts"], self.status()["unattended_allowed"]), (restarts, 2))
        self.assertEqual([event["text"] for event in self.events("unattended")],
                         [f"goes on without a person, {n} of the 2 times that resume.unattended allows" for n in (1, 2)])
        self.assertEqual(len(self.status()["holes"]), 2)
        self.assertEqual(self.refusal(), "it has done so 2 times since a person began it, as often as resume.unattended allows")
        # A person's order gives them all back.
        self.assertEqual(self.order("--resume").returncode, 0)
        self.killed()
        self.assertEqual(self.status()["unattended_restarts"], 0)
        self.killed()
        self.assertEqual(self.status()["unattended_restarts"], 1)

    def test_goes_on_after_the_watchdog(self):
        self.assertEqual(self.order(self.schedule).returncode, 0)
        process = self.begin(self.manager())
        process.send_signal(signal.SIGABRT)
        self.assertEqual(process.wait(60), 130)
        self.assertEqual([event["severity"] for event in self.events("watchdog")], ["warning"])
        self.killed()
        self.assertEqual(self.status()["unattended_restarts"], 1)

    def test_does_not_go_on_after_a_stop(self):
        # SIGTERM is the machine's where it comes from process 1 alone (tests/packaging/service_under_systemd.sh).
        for stop, words in ((signal.SIGINT, [self.schedule]), (signal.SIGTERM, ["--resume"])):
            self.assertEqual(self.order(*words).returncode, 0)
            process = self.begin(self.manager())
            process.send_signal(stop)
            self.assertEqual(process.wait(60), 130)
            self.assertRegex(self.refusal(), r"^its last run was not cut, but has ended \(.+\)$")

    def test_does_not_go_on_where_the_schedule_does_not_say_so(self):
        self.write(RULES)
        self.assertEqual(self.order(self.schedule).returncode, 0)
        self.killed()
        self.assertEqual(self.refusal(), "resume.unattended of its schedule is 0")

    def test_is_complete_and_then_there_is_nothing_to_do(self):
        self.assertEqual(self.run_it("run", self.schedule, "--out", self.out).returncode, 0)
        done = self.run_it("run", "--out", self.out, "--resume", "--unattended")
        self.assertEqual((done.returncode, done.stderr), (0, f"{self.out}: all cycles are complete; nothing to resume\n"))

    def test_resumes_without_the_schedule_what_was_extended(self):
        self.assertEqual(self.run_it("run", self.schedule, "--out", self.out).returncode, 0)
        longer = self.folder / "longer.yaml"
        longer.write_text(self.schedule.read_text().replace("cycles: 3", "cycles: 4"))
        self.assertEqual(self.run_it("run", longer, "--out", self.out, "--resume", "--extend", "--by-service").returncode, 0)
        self.assertEqual(self.run_it("run", "--out", self.out, "--resume").returncode, 0)
        self.assertEqual(self.status()["cycles_complete"], 4)

    def test_a_schedule_that_asks_a_person_and_asks_none_is_refused(self):
        self.write(RULES + "\n  unattended: 2")
        done = self.run_it("validate", self.schedule)
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r"schedule.yaml:\d+:\d+: error: unattended = 2 lets shafts move without a "
                                      r"person \(expected with it operator_acknowledges: false, and people who are kept away")
        self.write("operator_acknowledges: false\n  unattended: 2")
        self.assertIn("\nafter a cut a service goes on without a person, at most 2 times in a row; never after a fault or a stop\n",
                      self.run_it("validate", self.schedule).stdout)

    def test_says_what_is_missing(self):
        self.assertEqual(self.run_it("run", "--out", self.out).stderr,
                         "error: no schedule is given (expected strainwave run SCHEDULE --out DIR; a campaign that goes on with "
                         "--resume has its own)\n")
        self.assertFalse(self.out.exists())


def load_tests(_loader, tests, _pattern):
    return running_campaign.shard_of(tests)


if __name__ == "__main__":
    PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
