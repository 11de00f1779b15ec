#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The time of day is set by a day, slewed, goes through the ends of summer time; the clock that nobody sets passes 2^31 and
2^32 ms; the program stands still: campaigns measure the same, and what is said of their end stays sensible.

usage: clocks_test.py PROGRAM SET_CLOCK     SET_CLOCK: the library set_clock"""
import datetime
import json
import os
import pathlib
import re
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
from concurrent.futures import ThreadPoolExecutor

import campaign_journal
import running_campaign
from running_campaign import CHECKOUT, Campaign, until

PROGRAM, SET_CLOCK, FOLDER = "", "", pathlib.Path()
SHORT = CHECKOUT / "tests/power_cuts/short.yaml"
DAY_S = 86400.0
SECOND_NS = 10**9
PACE = 20.0  # some seconds for a campaign
HEARTBEAT_MISSED = "3081"  # emergency 8130h of CiA 301
ENABLE_OPERATION = 0x0F  # of CiA 402's controlword
ENDS_OF_SUMMER_TIME = ("2026-10-25T01:00:00Z", "2027-03-28T01:00:00Z")  # and of winter time


class Clock:
    """The time of day of what is run with its environment."""

    def __init__(self, name):
        self.file = FOLDER / f"{name}.clock"
        self.set(0.0)
        self.environment = {**os.environ, "LD_PRELOAD": SET_CLOCK, "STRAINWAVE_SET_CLOCK": str(self.file)}

    def set(self, offset_s):
        if not self.file.exists():
            self.file.write_bytes(bytes(8))
        with self.file.open("r+b") as file:
            file.write(struct.pack("<q", int(offset_s * SECOND_NS)))


def status(campaign, environment):
    done = subprocess.run([PROGRAM, "status", campaign, "--json"], capture_output=True, text=True, env=environment, check=True)
    return json.loads(done.stdout)


def moment(utc):
    return datetime.datetime.fromisoformat(utc.replace("Z", "+00:00"))


class OfASimulatedBench(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        subprocess.run([PROGRAM, "run", SHORT, "--out", FOLDER / "reference"], capture_output=True, check=True)
        cls.reference = campaign_journal.read(FOLDER / "reference")

    def run_with(self, clock, meanwhile, name):
        """Runs a campaign; `meanwhile` is called with its folder again and again; gives its events' (UTC, code)."""
        folder = FOLDER / name
        with open(FOLDER / f"{name}.words", "w+") as words:
            process = subprocess.Popen([PROGRAM, "run", SHORT, "--out", folder, "--pace", str(PACE)], env=clock.environment,
                                       stdin=subprocess.DEVNULL, stdout=words, stderr=words)
            self.addCleanup(process.kill)
            until(lambda: (folder / "checkpoint").exists())
            while process.poll() is None:
                meanwhile(folder)
                time.sleep(0.5)
            words.seek(0)
            self.assertEqual(process.returncode, 0, words.read())
        journal = campaign_journal.read(folder)
        self.assertEqual(journal.results, self.reference.results)
        self.assertEqual(journal.steps, self.reference.steps)
        self.assertEqual(journal.holes, 0)
        with tempfile.TemporaryDirectory() as copies:
            return campaign_journal.open_copy(folder / "campaign.db", copies).execute(
                "SELECT utc, code FROM events ORDER BY id").fetchall()

    def test_set_by_a_day_changes_no_result_and_no_forecast(self):
        def by(offset_s):
            clock, seen = Clock(f"{offset_s:.0f}"), []

            def look(folder):
                now = status(folder, clock.environment)
                if now["pace"] is None or not now["running"]:
                    return
                clock.set(offset_s)
                seen.append(status(folder, clock.environment))
            events = self.run_with(clock, look, f"set-by-{offset_s:.0f}")
            for now in seen:
                if not now["running"]:
                    continue
                self.assertGreater(now["pace"], 1.0)  # days, or backwards, where the day counted
                left_s = now["eta_s"] / now["pace"]
                self.assertLess(left_s, 600.0)
            self.assertTrue(seen)
            # The journal's own column of UTC tells what was done to the clock.
            jump_s = (moment(events[-1][0]) - moment(events[0][0])).total_seconds()
            self.assertLess(abs(jump_s - offset_s), 600.0)
        with ThreadPoolExecutor(2) as threads:
            list(threads.map(by, (DAY_S, -DAY_S)))

    def test_slewed_changes_nothing(self):
        clock, began = Clock("slewed"), time.monotonic()
        self.run_with(clock, lambda _: clock.set(0.05 * (time.monotonic() - began)), "slewed")

    def test_through_the_ends_of_summer_time_is_stored_as_utc(self):
        def through(end):
            clock = Clock(end)
            clock.environment["TZ"] = "Europe/Berlin"
            clock.set(moment(end).timestamp() - time.time() - 5.0)
            utc = [moment(text) for text, _ in self.run_with(clock, lambda _: None, end)]
            self.assertEqual(utc, sorted(utc))
            self.assertLess(utc[0], moment(end))
            self.assertGreater(utc[-1], moment(end))
            self.assertLess((utc[-1] - utc[0]).total_seconds(), 600.0)
        with ThreadPoolExecutor(2) as threads:
            list(threads.map(through, ENDS_OF_SUMMER_TIME))


class OfABenchInRealTime(unittest.TestCase):
    def test_set_by_a_day_and_back_no_limit_trips(self):
        clock = Clock("bench")
        campaign = Campaign(PROGRAM, FOLDER / "bench")
        self.addCleanup(campaign.kill)
        campaign.start(env=clock.environment).reach()
        for offset_s in (DAY_S, -DAY_S):
            clock.set(offset_s)
            campaign.credits(2.0)
            now = status(campaign.out, clock.environment)
            self.assertEqual([one["quantity"] for one in now["live"]["values"] if one["value"] is None], [])
        campaign.process.send_signal(signal.SIGINT)
        self.assertEqual(campaign.faults_after(campaign.end(), "quick_stop"), [])
        self.assertEqual(campaign.query("SELECT code FROM events WHERE severity = 'alarm'"), [])

    def test_that_nobody_sets_passes_the_ends_of_32_bits_of_milliseconds(self):
        if subprocess.run(["unshare", "--time", "--fork", "true"], capture_output=True, check=False).returncode != 0:
            self.skipTest("skipped, because this machine lets no test have a clock of its own")

        def pass_(end_s):
            campaign = Campaign(PROGRAM, FOLDER / f"end-{end_s}")
            ahead_s = int(end_s - time.monotonic()) - 10
            campaign.command = ["unshare", "--time", "--monotonic", str(ahead_s), "--boottime", str(ahead_s), "--fork",
                                "--kill-child", *campaign.command]
            self.addCleanup(campaign.kill)
            campaign.start().reach()
            until(lambda: campaign.alive() and time.monotonic() + ahead_s > end_s + 1.0)
            campaign.credits(2.0)
            process, = pathlib.Path(f"/proc/{campaign.process.pid}/task/{campaign.process.pid}/children").read_text().split()
            os.kill(int(process), signal.SIGINT)
            self.assertEqual(campaign.faults_after(campaign.end(), "quick_stop"), [])
        for bits in (31, 32):
            pass_(2**bits / 1000)

    def test_a_program_that_stood_still_stops_the_bench(self):
        # With its devices, which are in the same process, so that each misses the other. Drives that have missed the program
        # say no more statuswords.
        campaign = Campaign(PROGRAM, FOLDER / "stood_still")
        self.addCleanup(campaign.kill)
        campaign.start().reach()
        campaign.process.send_signal(signal.SIGSTOP)
        began = time.monotonic()
        until(lambda: time.monotonic() > began + 3.0)  # readings are stale after one
        campaign.process.send_signal(signal.SIGCONT)
        self.assertEqual(campaign.end(), 3, campaign.said())
        self.assertIn("stopped: torque is off, brakes are on", campaign.said())
        log = "".join(file.read_text() for file in sorted(campaign.out.glob("can/*.log")))
        for node in "12":
            self.assertIn(f" 08{node}#{HEARTBEAT_MISSED}", log)
            *_, low = re.findall(rf" 20{node}#(..)", log)
            self.assertNotEqual(int(low, 16) & ENABLE_OPERATION, ENABLE_OPERATION)
        campaign.start("--resume").credits(1.0)
        campaign.process.send_signal(signal.SIGINT)
        self.assertEqual(campaign.faults_after(campaign.end(), "quick_stop"), [])


def load_tests(_loader, tests, _pattern):
    return running_campaign.shard_of(tests)


if __name__ == "__main__":
    SET_CLOCK, PROGRAM = str(pathlib.Path(sys.argv.pop()).resolve()), sys.argv.pop()
    with tempfile.TemporaryDirectory() as scratch:
        FOLDER = pathlib.Path(scratch)
        unittest.main()
