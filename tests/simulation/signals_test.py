#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Every signal that can be caught ends a campaign safely: torque off, brakes on, exit code 130, resumable.

usage: signals_test.py PROGRAM     STRAINWAVE_SIGNAL_MATRIX=1: every signal in every kind of phase"""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor

import running_campaign
from running_campaign import Campaign, until

PROGRAM, FOLDER = "", pathlib.Path()
NEVER_CAUGHT = {signal.SIGKILL, signal.SIGSTOP}
HARMLESS = {signal.SIGCHLD, signal.SIGCONT, signal.SIGURG, signal.SIGWINCH}
# A reader that is gone, and a terminal in whose background the program is: these stop nothing.
IGNORED = {signal.SIGPIPE, signal.SIGTTIN, signal.SIGTTOU}
SOFTER = {signal.SIGTERM: "shutdown", signal.SIGUSR1: "pause", signal.SIGUSR2: "finish_cycle"}
ALL = set(signal.valid_signals()) - NEVER_CAUGHT - HARMLESS - IGNORED
MATRIX = os.environ.get("STRAINWAVE_SIGNAL_MATRIX") == "1"
REAL_TIME = set(range(signal.SIGRTMIN + 1, signal.SIGRTMAX))  # between the first and the last, all alike
QUICK = sorted(ALL - set(SOFTER) - (set() if MATRIX else REAL_TIME))


def name_of(number):
    return signal.Signals(number).name if number in set(signal.Signals) else f"signal {number}"


def stopped_by(number, kind, bench, pace="real"):
    """Faults of a campaign that gets this signal in this phase, is resumed, and then gets SIGINT."""
    where = FOLDER / f"{kind}-{int(number)}-{'bench' if bench else 'simulated'}"
    campaign = Campaign(PROGRAM, where, kind, bench, pace)
    try:
        campaign.start().reach()
        campaign.process.send_signal(number)
        faults = campaign.faults_after(campaign.end(), SOFTER.get(number, "quick_stop"))
        if not faults and (MATRIX or not bench):
            campaign.start("--resume").reach()
            campaign.process.send_signal(signal.SIGINT)
            faults = [f"resumed: {fault}" for fault in campaign.faults_after(campaign.end(), "quick_stop")]
    except AssertionError as error:
        faults = [str(error)]
    finally:
        campaign.kill()
    return [f"{name_of(number)} in {kind}: {fault}" for fault in faults]


class Signals(unittest.TestCase):
    def expect_none(self, faults):
        faults = [fault for found in faults for fault in found]
        self.assertEqual(faults, [], "\n".join(faults))

    def test_each_ends_a_load_run(self):
        # Simulated, so that several at a time hold up nothing.
        with ThreadPoolExecutor(4) as threads:
            self.expect_none(threads.map(lambda number: stopped_by(number, "load_run", None),
                                         QUICK + [signal.SIGTERM]))

    def test_each_ends_a_campaign_that_is_suspended(self):
        self.expect_none(stopped_by(number, "suspended", None, "300")
                         for number in (QUICK + [signal.SIGTERM] if MATRIX else [signal.SIGHUP]))

    def test_each_kind_of_phase_ends_with_torque_off_and_brakes_on(self):
        numbers = QUICK + [signal.SIGTERM] if MATRIX else [signal.SIGHUP]
        cases = [(number, kind) for kind in running_campaign.PHASES if kind != "suspended" for number in numbers]
        # They wait in real time and compute little.
        with ThreadPoolExecutor(3) as threads:
            self.expect_none(threads.map(lambda case: stopped_by(*case, running_campaign.BENCH), cases))

    def test_what_the_kernel_sends_for_output_and_terminals_stops_nothing(self):
        campaign = Campaign(PROGRAM, FOLDER / "ignored").start().reach()
        for number in IGNORED | HARMLESS:
            campaign.process.send_signal(number)
        campaign.credits(2.0)
        campaign.process.send_signal(signal.SIGINT)
        self.assertEqual(campaign.faults_after(campaign.end(), "quick_stop"), [])

    def test_a_hangup_that_was_ignored_before_stays_ignored(self):
        campaign = Campaign(PROGRAM, FOLDER / "nohup")
        campaign.start(preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN)).reach()
        campaign.process.send_signal(signal.SIGHUP)
        campaign.credits(2.0)
        campaign.process.send_signal(signal.SIGTSTP)
        self.assertEqual(campaign.faults_after(campaign.end(), "quick_stop"), [])

    def test_one_thread_alone_takes_signals(self):
        campaign = Campaign(PROGRAM, FOLDER / "masks").start().reach()
        takes = []
        for status in pathlib.Path(f"/proc/{campaign.process.pid}/task").glob("*/status"):
            fields = dict(line.split(":", 1) for line in status.read_text().splitlines())
            held_back = int(fields["SigBlk"], 16)
            takes.append({number for number in ALL if not held_back >> (number - 1) & 1})
        campaign.process.send_signal(signal.SIGINT)
        self.assertEqual(campaign.end(), 130)
        self.assertGreater(len(takes), 5)
        self.assertEqual([numbers for numbers in takes if numbers], [ALL])

    def test_a_softer_end_never_takes_back_a_stop(self):
        campaign = Campaign(PROGRAM, FOLDER / "softer").start().reach()
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGUSR1, signal.SIGUSR2):
            campaign.process.send_signal(number)
        self.assertEqual(campaign.faults_after(campaign.end(), "quick_stop"), [])

    def test_each_ends_the_waiting_for_a_person(self):
        for number in QUICK if MATRIX else [signal.SIGHUP]:
            with open(FOLDER / "person", "w+") as words:
                commission = subprocess.Popen([PROGRAM, "bench", "commission", running_campaign.BENCH],
                                              stdin=subprocess.PIPE, stdout=words, stderr=subprocess.STDOUT)
                until(lambda: "press Enter" in pathlib.Path(words.name).read_text())
                commission.stdin.write(b"not yet")  # no line
                commission.stdin.flush()
                commission.send_signal(number)
                self.assertEqual(commission.wait(60), 130, name_of(number))
                commission.stdin.close()
                words.seek(0)
                self.assertIn("nobody has confirmed, nothing was moved", words.read())

    def test_a_hand_that_jogs_is_let_go(self):
        for number in (QUICK if MATRIX else [signal.SIGHUP, signal.SIGTSTP]) + list(SOFTER):
            with open(FOLDER / "jog", "w+") as words:
                jog = running_campaign.jogging(PROGRAM, words)
                jog.send_signal(number)
                self.assertEqual(jog.wait(60), 130, name_of(number))
                jog.stdin.close()
                words.seek(0)
                self.assertIn("torque is off, the brakes are on", words.read())


def load_tests(_loader, tests, _pattern):
    return running_campaign.shard_of(tests)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    with tempfile.TemporaryDirectory() as scratch:
        FOLDER = pathlib.Path(scratch)
        unittest.main()
