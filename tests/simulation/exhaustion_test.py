#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""No more files may be opened, no more memory may be had, from the beginning or from a moment in a load run: a campaign comes
to its end, or says what is missing and leaves the bench with torque off, brakes on and a folder that is gone on with.

usage: exhaustion_test.py PROGRAM     STRAINWAVE_EXHAUSTION=1: every limit, not each of a few"""
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

import campaign_journal
import running_campaign
from running_campaign import CHECKOUT, Campaign, until

PROGRAM, FOLDER = "", pathlib.Path()
SHORT = CHECKOUT / "tests/power_cuts/short.yaml"
AT_LENGTH = os.environ.get("STRAINWAVE_EXHAUSTION") == "1"
INTERRUPTED, MACHINE_FAILED = 130, 3
LONGEST_S = 120
MIB = 1 << 20
STOPPED = "stopped: torque is off, brakes are on"
NO_DESCRIPTOR = "Too many open files"
NO_MEMORY = "no memory left|refuses this program another thread|allocate memory|out of memory"
NOT_LOADED = "error while loading shared libraries"


def run(*arguments, **limits):
    done = subprocess.run([PROGRAM, *map(str, arguments)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, timeout=LONGEST_S, check=False, **limits)
    return done.returncode, done.stdout.decode(errors="replace")


class FromTheBeginning(unittest.TestCase):
    def sweep(self, what, limits, words):
        """Until the program has all it needs; how often it had not."""
        refused = 0
        for most in limits:
            folder = FOLDER / f"{what}-{most}"
            code, text = run("run", SHORT, "--out", folder,
                             preexec_fn=lambda most=most: resource.setrlimit(what, (most, most)))
            if code == 0:
                return refused
            if not text or NOT_LOADED in text:
                continue
            refused += 1
            with self.subTest(most=most):
                self.assertEqual(code, MACHINE_FAILED, text)
                self.assertRegex(text.splitlines()[-1], words)
                self.expect_gone_on_with(folder, text)
        return self.fail("at no limit it had enough")

    def expect_gone_on_with(self, folder, text):
        if (folder / "campaign.db").exists():
            if campaign_journal.read(folder).phases:
                self.assertIn(STOPPED, text)
            for command in (["status", folder], ["verify", folder], ["run", SHORT, "--out", folder, "--resume"]):
                code, said = run(*command)
                self.assertEqual(code, 0, f"{command[0]}: {said}")
            self.assertEqual(campaign_journal.read(folder).complete, {0, 1, 2})
        shutil.rmtree(folder, ignore_errors=True)

    def test_descriptors(self):
        self.assertGreater(self.sweep(resource.RLIMIT_NOFILE, range(4, 40, 1 if AT_LENGTH else 3), NO_DESCRIPTOR), 2)

    def test_memory(self):
        step = MIB // 2 if AT_LENGTH else 6 * MIB
        self.assertGreater(self.sweep(resource.RLIMIT_AS, range(100 * MIB, 400 * MIB, step), NO_MEMORY), 2)


class InALoadRun(unittest.TestCase):
    def campaign(self, name, *, bench, pace="real"):
        campaign = Campaign(PROGRAM, FOLDER / name, bench=bench, pace=pace)
        self.addCleanup(campaign.kill)
        return campaign.start().reach()

    def expect_stopped(self, campaign, code, words):
        """Safe, in words, and gone on with."""
        self.assertEqual(code, MACHINE_FAILED, campaign.said())
        self.assertIn(STOPPED, campaign.said())
        self.assertRegex(campaign.said().splitlines()[-1], words)
        self.expect_safe(campaign)

    def expect_safe(self, campaign):
        drives, enabled = campaign.drive_words()
        self.assertTrue(enabled)
        for node, word in drives.items():
            self.assertNotEqual(word & running_campaign.STATE, running_campaign.OPERATION_ENABLED, f"{node}: {word:04X}h")
            self.assertTrue(word & running_campaign.BRAKE_ENGAGED, f"{node}: {word:04X}h")
        for command in ("status", "verify"):
            code, said = run(command, campaign.out)
            self.assertEqual(code, 0, said)
        campaign.start("--resume").credits(1.0)
        campaign.process.send_signal(signal.SIGINT)
        self.assertEqual(campaign.faults_after(campaign.end(), "quick_stop"), [])

    def test_no_file_can_be_opened_any_more(self):
        # Its rows are written after ten seconds, to a file that has to be made.
        campaign = self.campaign("files", bench=running_campaign.BENCH)
        resource.prlimit(campaign.process.pid, resource.RLIMIT_NOFILE, (3, 3))
        self.expect_stopped(campaign, campaign.end(), NO_DESCRIPTOR)

    def test_no_memory_can_be_had_any_more(self):
        campaign = self.campaign("memory", bench=running_campaign.BENCH)
        resource.prlimit(campaign.process.pid, resource.RLIMIT_AS, (1, 1))
        before_s = campaign.credited_s()
        until(lambda: campaign.process.poll() is not None or campaign.credited_s() > before_s + 5.0)
        campaign.process.send_signal(signal.SIGINT)
        code = campaign.end()
        if code == INTERRUPTED:  # it got along with what it had
            self.expect_safe(campaign)
        else:
            self.expect_stopped(campaign, code, NO_MEMORY)

    def test_a_simulated_campaign_has_a_little_more_and_then_none(self):
        for more in range(0, 12 * MIB, MIB if AT_LENGTH else 4 * MIB):
            folder = FOLDER / f"more-{more}"
            process = subprocess.Popen([PROGRAM, "run", SHORT, "--out", folder, "--pace", "200"], stdin=subprocess.DEVNULL,
                                       stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            until(lambda folder=folder: (folder / "checkpoint").exists())
            pages = int(pathlib.Path(f"/proc/{process.pid}/statm").read_text().split()[0])
            limit = pages * resource.getpagesize() + more
            resource.prlimit(process.pid, resource.RLIMIT_AS, (limit, limit))
            _, text = process.communicate(timeout=LONGEST_S)
            with self.subTest(more=more):
                if process.returncode != 0:
                    self.assertEqual(process.returncode, MACHINE_FAILED, text)
                    self.assertIn(STOPPED, text)
                    self.assertRegex(text.splitlines()[-1], NO_MEMORY)
                    self.assertEqual(run("run", SHORT, "--out", folder, "--resume")[0], 0)
                self.assertEqual(campaign_journal.read(folder).complete, {0, 1, 2})


def load_tests(_loader, tests, _pattern):
    return running_campaign.shard_of(tests)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    with tempfile.TemporaryDirectory() as scratch:
        FOLDER = pathlib.Path(scratch)
        unittest.main()
