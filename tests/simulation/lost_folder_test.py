#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A campaign's folder is moved, deleted, closed to writers, or asked for by a second run while it is under load.

usage: lost_folder_test.py PROGRAM"""
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

import running_campaign
from running_campaign import Campaign

PROGRAM, FOLDER = "", pathlib.Path()
MACHINE_FAILED, WRONG_INPUT = 3, 2
NOBODY = 65534
STOPPED = "stopped: torque is off, brakes are on, the campaign is whole; when the cause below is mended, go on with: "


class UnderLoad(unittest.TestCase):
    def campaign(self, **options):
        campaign = Campaign(PROGRAM, FOLDER / self.id().rsplit(".", 1)[-1], **options)
        self.addCleanup(campaign.kill)
        return campaign

    def expect_stopped(self, campaign, last_line):
        self.assertEqual(campaign.end(), MACHINE_FAILED, campaign.said())
        self.assertIn(STOPPED, campaign.said())
        self.assertEqual(campaign.said().splitlines()[-1], last_line)

    def expect_gone_on_with(self, campaign):
        campaign.start("--resume").credits(1.0)
        campaign.process.send_signal(signal.SIGINT)
        self.assertEqual(campaign.faults_after(campaign.end(), "quick_stop"), [])

    def test_a_folder_that_was_moved_is_named_where_it_is(self):
        campaign = self.campaign()
        campaign.start().reach()
        away = campaign.folder / "away"
        campaign.out.rename(away)
        self.expect_stopped(campaign, f"{campaign.out}: error: the folder is gone (expected the folder that this run began "
                            f"with, which is now {away})")
        self.assertFalse(campaign.out.exists(), "something was made in its place")
        away.rename(campaign.out)
        words, enabled = campaign.drive_words()
        self.assertTrue(enabled)
        for word in words.values():
            self.assertNotEqual(word & running_campaign.STATE, running_campaign.OPERATION_ENABLED)
            self.assertTrue(word & running_campaign.BRAKE_ENGAGED)
        self.expect_gone_on_with(campaign)

    def test_a_folder_that_was_deleted_is_not_made_again(self):
        campaign = self.campaign(bench=None, pace="50")
        campaign.start().reach()
        shutil.rmtree(campaign.out)
        self.expect_stopped(campaign, f"{campaign.out}: error: the folder is gone (expected the folder that this run began "
                            f"with, which is now {campaign.out} (deleted))")
        self.assertFalse(campaign.out.exists(), "something was made in its place")

    def test_a_folder_that_takes_no_more_files_ends_the_run(self):
        if os.geteuid() != 0:
            self.skipTest("skipped, because only root can be somebody else")
        program = FOLDER / "strainwave"  # where anybody may run it
        shutil.copy(PROGRAM, program)
        campaign = self.campaign(bench=None, pace="20")
        os.chown(campaign.folder, NOBODY, NOBODY)
        campaign.command[0] = str(program)
        campaign.start(user=NOBODY, group=NOBODY, extra_groups=()).reach()
        unfinished = campaign.out / "unfinished"
        unfinished.chmod(0o555)
        # Its rows are written after ten seconds of the world's.
        rows = unfinished / "000001-000-00-001.rows"
        self.expect_stopped(campaign, f"cannot write '{rows}': Permission denied")
        unfinished.chmod(0o755)
        self.expect_gone_on_with(campaign)

    def test_a_second_run_is_refused_and_the_first_goes_on(self):
        campaign = self.campaign()
        campaign.start().reach()
        for more in ([], ["--resume"]):
            second = subprocess.run([*map(str, campaign.command), *more], capture_output=True, text=True, check=False,
                                    stdin=subprocess.DEVNULL, timeout=60)
            self.assertEqual(second.returncode, WRONG_INPUT)
            self.assertEqual(second.stderr.splitlines()[-1], f"{campaign.out}: error: " + (
                f"the campaign is running in process {campaign.process.pid} (expected a folder that no other process runs)"
                if more else
                "the folder holds a campaign already (expected a new folder, or --resume to go on with it)"))
        campaign.credits(1.0)
        campaign.process.send_signal(signal.SIGINT)
        self.assertEqual(campaign.faults_after(campaign.end(), "quick_stop"), [])


def load_tests(_loader, tests, _pattern):
    return running_campaign.shard_of(tests)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    with tempfile.TemporaryDirectory() as scratch:
        FOLDER = pathlib.Path(scratch)
        FOLDER.chmod(0o755)
        unittest.main()
