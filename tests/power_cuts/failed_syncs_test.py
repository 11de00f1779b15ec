#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A checkpoint and growing records on a disk of which a sync fails, and whose power then goes.

usage: failed_syncs_test.py SYNCED_WRITES POWER_CUT_DISK     exit code 77: skipped, with the reason"""
import itertools
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import cut_disk

WRITES = SERVER = pathlib.Path()


def synced_in(text):
    return max(map(int, re.findall(r"synced (\d+)", text)), default=0)


class FilesOnADisk(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.disks = (cut_disk.CutDisk(SERVER, pathlib.Path(folder.name) / str(number)) for number in itertools.count())

    def run_on(self, disk, *counts, kind="checkpoint", **options):
        commands = [lambda place, count=count: [WRITES, kind, place, str(count)] for count in counts]
        return disk.run(*commands, environment={}, **options)

    def demand_kept(self, disk, said, cut):
        command = [WRITES, "checkpoint", disk.side("disk"), "0"]
        left = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False).stdout
        self.assertRegex(left, r"^holds \d+", cut)
        self.assertGreaterEqual(int(left.split()[1]), synced_in(said), f"{cut}: {said}")

    def test_a_checkpoint_keeps_what_was_synced_wherever_the_power_goes(self):
        for seed in range(3):
            cut, cut_at = True, 0
            while cut:
                cut_at += 1
                disk = next(self.disks)
                done = self.run_on(disk, 8, cut_at=cut_at, seed=seed)
                cut = done.cut
                # Of a file that was not made there is nothing to be said.
                if synced_in(done.text) > 0:
                    self.demand_kept(disk, done.text, f"cut at {cut_at}, seed {seed}")

    def demand_nothing_more(self, kind, what, fail_sync):
        said = self.run_on(next(self.disks), 6, kind=kind, fail_sync=fail_sync).text.splitlines()
        self.assertEqual(said[:4], ["holds 0", "synced 1", "synced 2", said[3]])
        self.assertRegex(said[3], f"^{what} '.*': Input/output error$")
        self.assertEqual(said[4:], [said[3]] * 3)

    def test_nothing_more_is_written_after_a_sync_that_failed(self):
        # When it is made its file, the folder, and once more; of the rows the folder.
        self.demand_nothing_more("checkpoint", "cannot sync the checkpoint", fail_sync=3 + 3)
        self.demand_nothing_more("rows", "cannot sync", fail_sync=1 + 3)

    def test_a_state_that_failed_to_be_synced_is_no_ground_for_the_next_program(self):
        for seed, cut_after in itertools.product(range(4), range(1, 13)):
            disk = next(self.disks)
            done = self.run_on(disk, 6, 6, fail_sync=6, cut_after=cut_after, seed=seed)
            self.demand_kept(disk, done.text, f"cut {cut_after} after, seed {seed}")


if __name__ == "__main__":
    SERVER, WRITES = (pathlib.Path(sys.argv.pop()).resolve() for _ in range(2))
    cut_disk.begin_in_own_mounts()
    if why := cut_disk.is_possible(SERVER):
        print(f"skipped, because {why}")
        sys.exit(cut_disk.SKIPPED)
    unittest.main()
