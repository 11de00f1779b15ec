#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Output that cannot be written stops nothing: terminals that are held, closed or gone, full disks, closed pipes.

usage: output_test.py PROGRAM"""
import fcntl
import os
import pathlib
import pty
import signal
import subprocess
import sys
import tempfile
import termios
import unittest

import running_campaign
from running_campaign import Campaign, until

PROGRAM, FOLDER = "", pathlib.Path()
CTRL_C, CTRL_S, CTRL_Z, CTRL_BACKSLASH = b"\x03", b"\x13", b"\x1a", b"\x1c"


def take_terminal(ignored=()):
    """In the child: its standard input becomes its controlling terminal."""
    os.setsid()
    fcntl.ioctl(0, termios.TIOCSCTTY, 0)
    for number in ignored:
        signal.signal(number, signal.SIG_IGN)


def of_two_cycles(campaign):
    """The same with load runs of a few simulated minutes, so that it comes to its end."""
    schedule = campaign.folder / "schedule.yaml"
    schedule.write_text(schedule.read_text().replace("duration: 20 min", "duration: 2 min"))
    return campaign


def without_streams(*closed):
    return lambda: [os.close(number) for number in closed]


class OnATerminal(unittest.TestCase):
    def setUp(self):
        self.master, self.slave = pty.openpty()
        self.campaign = Campaign(PROGRAM, FOLDER / self.id().rsplit(".", 1)[-1])

    def tearDown(self):
        self.campaign.kill()
        for end in {self.master, self.slave} - {None}:
            os.close(end)

    def start(self, ignored=()):
        self.campaign.start(stdin=self.slave, stdout=self.slave, stderr=self.slave,
                            preexec_fn=lambda: take_terminal(ignored))
        os.close(self.slave)
        self.slave = None
        self.campaign.reach()

    def close(self):
        os.close(self.master)
        self.master = None

    def expect_stopped(self, code):
        self.assertEqual(self.campaign.faults_after(code, "quick_stop"), [])

    def test_that_is_closed_a_campaign_stops(self):
        self.start()
        self.close()
        self.expect_stopped(self.campaign.end())

    def test_that_is_gone_a_campaign_that_ignores_it_goes_on(self):
        self.start(ignored=[signal.SIGHUP])
        self.close()
        self.campaign.credits(3.0)
        self.campaign.process.send_signal(signal.SIGINT)
        self.expect_stopped(self.campaign.end())

    def test_that_is_held_no_checkpoint_waits_and_ctrl_c_stops(self):
        self.start()
        os.write(self.master, CTRL_S)
        credited_s = self.campaign.credits(4.0)
        os.write(self.master, CTRL_C)
        self.expect_stopped(self.campaign.end())
        (in_the_journal_s,), = self.campaign.query("SELECT SUM(credited_load_s) FROM phases")
        self.assertGreaterEqual(in_the_journal_s, credited_s)

    def test_that_stays_held_nothing_waits_for_it_at_the_end(self):
        self.start()
        os.write(self.master, CTRL_S)
        self.campaign.credits(4.0)
        self.campaign.process.send_signal(signal.SIGTERM)
        self.assertEqual(self.campaign.faults_after(self.campaign.end(), "shutdown"), [])

    def test_its_key_for_suspending_a_program_stops_the_bench(self):
        self.start()
        os.write(self.master, CTRL_Z)
        self.expect_stopped(self.campaign.end())

    def test_its_key_for_quitting_a_program_stops_the_bench(self):
        self.start()
        os.write(self.master, CTRL_BACKSLASH)
        self.expect_stopped(self.campaign.end())


class ProgressOnATerminal(unittest.TestCase):
    def test_stands_in_no_line_of_the_results(self):
        FOLDER.mkdir(parents=True, exist_ok=True)
        record = FOLDER / "sweep.csv"
        subprocess.run([PROGRAM, "simulate", "transmission_error", "--out", str(record)], check=True, capture_output=True)
        master, slave = pty.openpty()
        process = subprocess.Popen([PROGRAM, "recompute", str(record)], stdin=slave, stdout=slave, stderr=slave)
        os.close(slave)
        written = b""
        while True:
            try:
                written += os.read(master, 65536)
            except OSError:  # nobody writes any more
                break
        os.close(master)
        self.assertEqual(process.wait(), 0)
        lines = written.decode().replace("\r\n", "\n").split("\n")
        self.assertIn("reading sweep.csv", lines[0])
        self.assertIn(f"{record}: transmission_error", [line.split("\r\033[K")[-1] for line in lines])


class ThatCannotBeWritten(unittest.TestCase):
    def complete(self, name, **streams):
        campaign = of_two_cycles(Campaign(PROGRAM, FOLDER / name, bench=None, pace="max"))
        campaign.start(**streams)
        self.assertEqual(campaign.end(), 0, campaign.said())
        self.assertEqual([row for row in campaign.query("SELECT outcome FROM cycles WHERE cycle > 0")],
                         [("complete",)] * 2)
        return campaign

    def words_after(self, code, *arguments, **streams):
        ended = subprocess.run([PROGRAM, *map(str, arguments)], stdin=subprocess.DEVNULL, check=False,
                               **({"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | streams))
        self.assertEqual(ended.returncode, code, ended.stderr)
        return (ended.stderr or b"").decode()

    def test_on_a_full_disk_a_campaign_is_complete(self):
        with open("/dev/full", "w") as full:
            self.complete("full_words", stderr=full)
            told = self.complete("full_results", stdout=full)
        self.assertIn("error: standard output could not be written: No space left on device\n", told.said())

    def test_into_a_pipe_that_nobody_reads_a_campaign_is_complete(self):
        reads, writes = os.pipe()
        os.close(reads)
        self.complete("pipe", stdout=writes, stderr=writes)
        os.close(writes)

    def test_a_full_pipe_holds_up_no_campaign(self):
        reads, writes = os.pipe()
        os.set_blocking(writes, False)
        for piece in (4096, 1):  # to the last byte
            try:
                while True:
                    os.write(writes, b"x" * piece)
            except BlockingIOError:
                pass
        os.set_blocking(writes, True)
        self.complete("full_pipe", stderr=writes)
        os.close(reads), os.close(writes)

    def test_closed_streams_are_no_file_of_the_campaign(self):
        for closed in ((0,), (1,), (2,), (0, 1, 2)):
            with self.subTest(closed=closed):
                name = "closed" + "".join(map(str, closed))
                campaign = self.complete(name, preexec_fn=without_streams(*closed))
                self.words_after(0, "recompute", campaign.out)
                self.assertRegex((campaign.out / "lock").read_text(), r"\A\d+\n\Z")

    def test_results_are_told_and_are_exit_code_3(self):
        campaign = self.complete("results")
        for command in (["status", campaign.out], ["status", campaign.out, "--json"], ["--help"],
                        ["validate", campaign.folder / "schedule.yaml"], ["recompute", campaign.out]):
            with self.subTest(command=command), open("/dev/full", "w") as full:
                self.assertIn("error: standard output could not be written: No space left on device\n",
                              self.words_after(3, *command, stdout=full))
                self.assertIn("error: standard output could not be written: Bad file descriptor\n",
                              self.words_after(3, *command, stdout=None, preexec_fn=without_streams(1)))

    def test_results_that_nobody_wants_any_more_are_no_error(self):
        campaign = self.complete("unwanted")
        reads, writes = os.pipe()
        os.close(reads)
        self.assertEqual(self.words_after(0, "status", campaign.out, stdout=writes), "")
        os.close(writes)

    def test_words_change_no_exit_code(self):
        with open("/dev/full", "w") as full:
            self.words_after(2, "validate", "nothing", stderr=full)
            self.words_after(2, "no_command", stderr=full)
            self.words_after(2, "status", FOLDER / "nothing", stderr=full)
        self.words_after(2, "validate", "nothing", stderr=None, preexec_fn=without_streams(2))

    def test_a_hand_that_jogs_is_let_go_where_nobody_reads(self):
        reads, writes = os.pipe()
        with open(FOLDER / "jogging", "w+") as words:
            jog = running_campaign.jogging(PROGRAM, words)
            jog.stdin.close()
            self.assertEqual(jog.wait(60), 0)
        jog = subprocess.Popen([PROGRAM, "bench", "jog", running_campaign.BENCH, "--drive", "driving"],
                               stdin=subprocess.PIPE, stdout=writes, stderr=writes)
        os.close(writes)
        until(lambda: b"is held" in os.read(reads, 4096))
        os.close(reads)
        jog.stdin.write(b"\n" * 10)
        jog.stdin.close()
        self.assertEqual(jog.wait(60), 0)


def load_tests(_loader, tests, _pattern):
    return running_campaign.shard_of(tests)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    with tempfile.TemporaryDirectory() as scratch:
        FOLDER = pathlib.Path(scratch)
        unittest.main()
