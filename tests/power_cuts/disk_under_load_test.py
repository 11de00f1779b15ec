#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A bench in real time on a disk whose syncs begin to fail, and on one whose writes take seconds: torque is off and brakes are
on by the log of the bus, whatever becomes of the disk.

usage: disk_under_load_test.py [TEST] PROGRAM POWER_CUT_DISK     exit code 77: skipped, with the reason"""
import datetime
import errno
import pathlib
import re
import signal
import sys
import tempfile
import unittest

import cut_disk

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "simulation"))
import running_campaign  # noqa: E402
from running_campaign import Campaign, until  # noqa: E402

PROGRAM = SERVER = pathlib.Path()
MACHINE_FAILED = 3
SLOW_MS = 2000
WAITS_FOR_DISK = "request_wait_answer"
LONGEST_S = 900  # until it is written down


class UnderLoad(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.disk = cut_disk.CutDisk(SERVER, pathlib.Path(folder.name) / "disk")

    def campaign(self, place):
        campaign = Campaign(PROGRAM, place / "bench")
        self.addCleanup(campaign.kill)
        return campaign

    def expect_safe(self, campaign):
        words, enabled = campaign.drive_words()
        self.assertTrue(enabled)
        for node, word in words.items():
            self.assertNotEqual(word & running_campaign.STATE, running_campaign.OPERATION_ENABLED, f"{node}: {word:04X}h")
            self.assertTrue(word & running_campaign.BRAKE_ENGAGED, f"{node}: {word:04X}h")

    def last_enabled(self, campaign):
        """When a drive said so for the last time."""
        log = "".join(file.read_text() for file in campaign.out.glob("can/*.log"))
        stamps = [float(stamp) for stamp, low, high in re.findall(r"\(([0-9.]+)\) \S+ 18[12]#(..)(..)", log)
                  if int(high + low, 16) & running_campaign.STATE == running_campaign.OPERATION_ENABLED]
        return datetime.datetime.fromtimestamp(max(stamps), datetime.timezone.utc)

    def test_syncs_that_fail_from_there_on(self):
        # Of the journal and the first of the checkpoint there are fewer; the log of the bus is synced never.
        with self.disk.mounted(fail_at=60, errno=errno.EIO, lasting=1, only="sync") as (place, report):
            campaign = self.campaign(place).start()
            code = campaign.end()
            self.disk.mend()
            self.assertEqual(code, MACHINE_FAILED, campaign.said())
            self.assertIn("stopped: torque is off, brakes are on", campaign.said())
            self.assertEqual(campaign.said().splitlines()[-1],
                             f"cannot sync the checkpoint '{campaign.out}/checkpoint': Input/output error")
            self.expect_safe(campaign)
            campaign.start("--resume").credits(1.0)
            campaign.process.send_signal(signal.SIGINT)
            self.assertEqual(campaign.faults_after(campaign.end(), "quick_stop"), [])
        self.assertEqual(report["failed"], "sync checkpoint")

    def test_writes_that_take_seconds(self):
        with self.disk.mounted(write_ms=SLOW_MS) as (place, _):
            campaign = self.campaign(place).start().reach()
            self.disk.change_pace()
            process = pathlib.Path(f"/proc/{campaign.process.pid}")

            def writes():
                return int(re.search(r"syscw: (\d+)", (process / "io").read_text())[1])
            before = writes()
            until(lambda: writes() > before + 20)
            until(lambda: (process / "wchan").read_text() == WAITS_FOR_DISK)
            campaign.process.send_signal(signal.SIGINT)
            (noted,), = until(lambda: campaign.query("SELECT utc FROM events WHERE code = 'quick_stop'"), LONGEST_S)
            self.disk.change_pace()
            self.assertEqual(campaign.faults_after(campaign.end(), "quick_stop"), [])
            self.assertLess(self.last_enabled(campaign), datetime.datetime.fromisoformat(noted.replace("Z", "+00:00")))
            self.assertEqual(campaign.query("SELECT code FROM events WHERE severity = 'alarm'"), [])


if __name__ == "__main__":
    SERVER, PROGRAM = (pathlib.Path(sys.argv.pop()).resolve() for _ in range(2))
    cut_disk.begin_in_own_mounts()
    if why := cut_disk.is_possible(SERVER):
        print(f"skipped, because {why}")
        sys.exit(cut_disk.SKIPPED)
    unittest.main()
