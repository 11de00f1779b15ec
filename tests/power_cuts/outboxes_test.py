#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What waits for a broker, and the notices of a watch, on a disk whose power goes with the k-th operation.

usage: outboxes_test.py WAITING_MESSAGES POWER_CUT_DISK [EVERY]     exit code 77: skipped, with the reason

Every k, or every so many, until all messages are there before; then what is left is opened and gone on with, and the
power goes in that, too; likewise where the k-th sync fails, of which there are few, so each. What was shown is with the
receiver or waits; what was removed does not come again."""
import collections
import itertools
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import unittest

import cut_disk

PROGRAM = SERVER = pathlib.Path()
EVERY = 1
MESSAGES = 7
UNDER_WAY = 2  # of waiting_messages.cc


class Receiver:
    """What was shown and received, written down outside of the disk."""

    def __init__(self):
        self.shown, self.received, self.removed = set(), collections.Counter(), set()
        self.last = self.birth = 0

    def note(self, text):
        numbers = {word: list(map(int, re.findall(rf"^{word} (\d+)$", text, re.MULTILINE)))
                   for word in ("shown", "received", "removed", "birth")}
        self.shown |= set(numbers["shown"])
        self.received.update(numbers["received"])
        self.removed |= set(numbers["removed"])
        self.last = max([self.last, *numbers["shown"]])
        self.birth = max([self.birth, *numbers["birth"]])


class Outboxes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.disks = (cut_disk.CutDisk(SERVER, pathlib.Path(folder.name) / str(number)) for number in itertools.count())
        self.cuts = self.doubled = 0

    def run_on(self, disk, kind, count=MESSAGES, **options):
        return disk.run(lambda place: [PROGRAM, kind, place, str(count)], environment={}, **options)

    def demand_kept(self, disk, kind, receiver, where):
        """What is left can be opened, and is what it must be."""
        done = subprocess.run([PROGRAM, kind, disk.side("disk"), "0"], stdout=subprocess.PIPE, text=True, check=False)
        self.assertEqual(done.returncode, 0, f"{where}: cannot be opened: {done.stdout}")
        held = list(map(int, re.search(r"^holds ?(.*)$", done.stdout, re.MULTILINE)[1].split()))
        self.assertEqual(held, sorted(set(held)), f"{where}: in order, each once")
        lost = receiver.shown - set(held) - set(receiver.received)
        self.assertEqual(lost, set(), f"{where}: lost, of what was shown")
        self.assertEqual(receiver.removed & set(held), set(), f"{where}: comes again")
        last = int(re.search(r"^last (\d+)$", done.stdout, re.MULTILINE)[1])
        self.assertGreaterEqual(last, receiver.last, f"{where}: a number is given twice")
        self.assertLessEqual(max(held, default=0), last, where)
        if kind == "windows":
            birth = int(re.search(r"^birth (\d+)$", done.stdout, re.MULTILINE)[1])
            self.assertGreaterEqual(birth, receiver.birth, f"{where}: a connection's number is given twice")

    def try_cut(self, kind, chance, **options):
        """Whether the power went, or a sync failed; where one fails, the power goes in every second case a while later."""
        disk, receiver = next(self.disks), Receiver()
        if "fail_sync" in options and chance.random() < 0.5:
            options["cut_after"] = chance.randint(1, 40)
        done = self.run_on(disk, kind, seed=chance.getrandbits(32), **options)
        receiver.note(done.text)
        where = f"{kind}, {options}, with {done.last_operation}: {done.text}"
        if done.cut or done.failed_sync:
            self.cuts += 1
            self.demand_kept(disk, kind, receiver, where)
            again = self.run_on(disk, kind, seed=chance.getrandbits(32), cut_at=chance.randint(1, 60))
            self.doubled += again.cut
            receiver.note(again.text)
            self.demand_kept(disk, kind, receiver, f"{where}, and then with {again.last_operation}: {again.text}")
            final = self.run_on(disk, kind, seed=1)
            receiver.note(final.text)
            self.assertEqual(final.code, 0, f"{where}: {final.text}")
            self.demand_kept(disk, kind, receiver, where)
        else:
            self.assertEqual(done.code, 0, where)
            self.demand_kept(disk, kind, receiver, where)
        # Under way when the power went, each time.
        twice = sum(count - 1 for count in receiver.received.values())
        self.assertLessEqual(twice, 2 * UNDER_WAY, where)
        return done.cut or bool(done.failed_sync)

    def try_each(self, kind, option, **further):
        chance = random.Random(5)
        every = EVERY if option == "cut_at" else 1
        for number in itertools.count(1 + chance.randrange(every), every):
            if not self.try_cut(kind, chance, **{option: number}, **further):
                break
        self.assertGreater(self.cuts, 0)
        print(f"{kind}, {option}: {self.cuts} tried, {self.doubled} of them cut again")

    def test_windows_wherever_the_power_goes(self):
        self.try_each("windows", "cut_at")

    def test_windows_where_a_sync_fails(self):
        self.try_each("windows", "fail_sync")

    def test_notices_wherever_the_power_goes(self):
        self.try_each("notices", "cut_at")

    def test_notices_where_a_sync_fails(self):
        self.try_each("notices", "fail_sync")

    FOUND = "lost, of what was shown|: a[a-z' ]+ is given twice|: cannot be opened: "

    def test_that_nothing_is_synced_would_be_found(self):
        for kind in ("windows", "notices"):
            with self.assertRaisesRegex(AssertionError, self.FOUND, msg=kind):
                self.try_each(kind, "cut_at", forget="")


if __name__ == "__main__":
    if len(sys.argv) > 3:
        EVERY = int(sys.argv.pop())
    SERVER, PROGRAM = (pathlib.Path(sys.argv.pop()).resolve() for _ in range(2))
    cut_disk.begin_in_own_mounts()
    if why := cut_disk.is_possible(SERVER):
        print(f"skipped, because {why}")
        sys.exit(cut_disk.SKIPPED)
    unittest.main()
