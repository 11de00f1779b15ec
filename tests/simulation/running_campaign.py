# SPDX-License-Identifier: Apache-2.0
"""A campaign with one kind of phase in front of a test, and what the journal and the drives themselves say of it."""
import contextlib
import os
import pathlib
import re
import signal
import sqlite3
import subprocess
import sys
import tempfile
import unittest

import campaign_journal

CHECKOUT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(CHECKOUT / "tests/bench/peers"))
from waiting import until  # noqa: E402

BENCH = CHECKOUT / "tests/simulation/field/bench.yaml"
SMALL = (CHECKOUT / "tests/simulation/small.yaml").read_text()
LOAD_RUN = "duration: 20 min, output_torque: 40 Nm, input_speed: 2400 rpm, torque_rate: 200 Nm/s"
# Each long enough for a signal to meet it.
PHASES = {
    "load_run": LOAD_RUN,
    "measurement_rotation": "turns: 60, output_torque: 40 Nm, input_speed: 2400 rpm, vibration_rate: 12.8 kHz",
    "transmission_error": "step: 5 deg, steps: 72, directions: both, input_speed: 300 rpm",
    "hysteresis": "peak_torque: 34 Nm, torque_rate: 1 Nm/s, lock_angles: 0 deg",
    "zero_check": "allowed: 5 Nm",
    "shunt_check": "expected: 50 Nm, allowed: 5 Nm, duration: 60 s",
    "reference_check": "allowed: 30 arcmin, duration: 60 s",
    "soak": "below_temperature: -40 degC, at_most: 2 h",
    "blank_test": "peak_torque: 34 Nm, torque_rate: 1 Nm/s, steps: 36",
    "suspended": LOAD_RUN,  # soon: its gear gets warmer than it may be
}
IN_PREPARATION = ("soak", "blank_test")
WITHOUT_TORQUE = ("shunt_check", "reference_check", "soak", "suspended")

# CiA 402: statusword bits, the brake's where the drive's profile has it.
STATE, OPERATION_ENABLED, BRAKE_ENGAGED = 0x6F, 0x27, 0x4000


def schedule_of(kind):
    head, rest = SMALL.split("cycles: 3")
    if kind == "suspended":
        head = head.replace("trip_temperature: 70", "trip_temperature: 26")
        head = head.replace("resume_temperature: 60", "resume_temperature: 10")
    phase = f"  - {{kind: {'load_run' if kind == 'suspended' else kind}, {PHASES[kind]}}}\n"
    before = f"preparation:\n{phase}" if kind in IN_PREPARATION else ""
    phases = f"  - {{kind: load_run, {LOAD_RUN}}}\n" if before else phase
    measurements = rest[rest.index("measurements:"):].replace("repeatability_repeats: 2", "repeatability_repeats: 0")
    return f"{head}cycles: 2\n{before}phases:\n{phases}{measurements}"


class Campaign:
    def __init__(self, program, folder, kind="load_run", bench=BENCH, pace="real"):
        self.program, self.kind, self.bench = program, kind, bench
        self.folder = pathlib.Path(folder)
        self.folder.mkdir(parents=True)
        self.out = self.folder / "campaign"
        schedule = self.folder / "schedule.yaml"
        schedule.write_text(schedule_of(kind))
        (self.folder / "people.txt").write_text("\n" * 20)  # somebody says that the blank is mounted
        self.command = [program, "run", schedule, "--out", self.out]
        self.command += ["--bench", bench] if bench else ["--pace", pace]
        self.process = None

    def start(self, *more, **streams):
        """On files of the campaign's folder, unless streams are given."""
        self.suspended_before = self.times_suspended()
        with contextlib.ExitStack() as files:
            for name, mode in (("stdin", "r"), ("stdout", "a"), ("stderr", "a")):
                if name not in streams:
                    path = self.folder / ("people.txt" if name == "stdin" else name)
                    streams[name] = files.enter_context(open(path, mode))
            self.process = subprocess.Popen([*map(str, self.command), *more], **streams)
        return self

    def query(self, sql):
        try:
            with tempfile.TemporaryDirectory() as copies, \
                    contextlib.closing(campaign_journal.open_copy(self.out / "campaign.db", copies)) as database:
                return database.execute(sql).fetchall()
        except (sqlite3.Error, OSError):  # not there yet, or copied while it was written
            return []

    def alive(self):
        if self.process.poll() is None:
            return True
        raise AssertionError(f"ended with {self.process.returncode}: {self.said()}")

    def said(self):
        return (self.folder / "stderr").read_text() if (self.folder / "stderr").exists() else ""

    def drive_words(self):
        """Newest statusword of each drive, as it was on the bus, and whether any was enabled."""
        newest, enabled = {}, False
        for log in sorted(self.out.glob("can/*.log")):
            for node, low, high in re.findall(r" 18([12])#(..)(..)", log.read_text()):
                newest[node] = int(high + low, 16)
                enabled = enabled or newest[node] & STATE == OPERATION_ENABLED
        return newest, enabled

    def times_suspended(self):
        return len(self.query("SELECT 1 FROM events WHERE code = 'temperature_suspend'"))

    def is_under_way(self):
        self.alive()
        if self.kind == "suspended":
            return self.times_suspended() > self.suspended_before
        if not self.query(f"SELECT 1 FROM phases WHERE kind = '{self.kind}' AND outcome = 'running'"):
            return False
        return self.kind in WITHOUT_TORQUE or not self.bench or self.drive_words()[1]

    def reach(self):
        until(self.is_under_way)
        return self

    def credited_s(self):
        """As the checkpoint has it now."""
        self.alive()
        text = subprocess.run([self.program, "status", self.out, "--json"], capture_output=True, text=True).stdout
        found = re.search(r'"credited_load_s": ([0-9.e+-]+)', text)
        return float(found[1]) if found else 0.0

    def credits(self, more_s):
        """Goes on under load for so long."""
        before = self.credited_s()
        until(lambda: self.credited_s() > before + more_s)
        return self.credited_s()

    def end(self, seconds=60):
        try:
            return self.process.wait(seconds)
        except subprocess.TimeoutExpired as error:
            raise AssertionError(f"goes on: {self.said()[-300:]}") from error
        finally:
            self.kill()

    def kill(self):
        if self.process and self.process.poll() is None:
            self.process.kill()
            self.process.wait()

    def faults_after(self, code, event):
        """What is not as it must be after a stop, in words; nothing where all is."""
        faults = []
        if code != 130:
            faults.append(f"exit code {code}: {self.said()[-300:]}")
        events = [row[0] for row in self.query("SELECT code FROM events")]
        if event not in events:
            faults.append(f"no {event} among the events {events}")
        if left := self.query("SELECT name FROM phases WHERE outcome = 'running'"):
            faults.append(f"still running: {left}")
        if self.bench:
            words, enabled = self.drive_words()
            if not enabled and self.kind not in WITHOUT_TORQUE:
                faults.append("no drive was ever enabled")
            for node, word in words.items():
                if word & STATE == OPERATION_ENABLED or not word & BRAKE_ENGAGED:
                    faults.append(f"drive {node} says {word:04X}h at the end")
        return faults


def jogging(program, words):
    """`bench jog` with a hand that holds Enter, once the shaft turns."""
    jog = subprocess.Popen([program, "bench", "jog", BENCH, "--drive", "driving", "--speed", "10 rpm"],
                           stdin=subprocess.PIPE, stdout=words, stderr=subprocess.STDOUT)

    def turns():
        jog.stdin.write(b"\n")
        jog.stdin.flush()
        said = pathlib.Path(words.name).read_text()
        return any(float(turned) > 5.0 for turned in re.findall(r"([0-9.-]+) deg turned", said))
    until(turns)
    return jog


def shard_of(suite):
    """The share of its tests that in_shards.sh asks this process for, as it asks GoogleTest's programs."""
    for number in (signal.SIGINT, signal.SIGQUIT):  # a shell has what it puts in the background ignore these
        signal.signal(number, signal.SIG_DFL)

    def each(tests):
        for test in tests:
            yield from each(test) if isinstance(test, unittest.TestSuite) else [test]
    shards, index = (int(os.environ.get(name, default)) for name, default in
                     (("GTEST_TOTAL_SHARDS", 1), ("GTEST_SHARD_INDEX", 0)))
    return unittest.TestSuite(list(each(suite))[index::shards])
