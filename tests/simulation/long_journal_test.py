#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A journal of very many cycles: `status` compares what it shows with the checksums, and all of it when asked.

usage: long_journal_test.py PROGRAM"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "benchmarks"))
import long_campaign  # noqa: E402

PROGRAM, CAMPAIGN = "", pathlib.Path()
CYCLES = 25000
PAGE_BYTES = 4096


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def pages_shown():
    """Pages of the file that `status` reads."""
    done = subprocess.run(["/usr/bin/strace", "-f", "-y", "-e", "trace=pread64", PROGRAM, "status", CAMPAIGN],
                          capture_output=True, text=True, check=True)
    return sum("campaign.db>" in line for line in done.stderr.splitlines())


class LongJournal(unittest.TestCase):
    def test_is_told_to_be_compared_as_it_is_read(self):
        self.assertIn(f"journal      what is shown was compared with its checksums; all of it: strainwave status {CAMPAIGN} "
                      "--check-all\n", run("status", CAMPAIGN)[1])
        self.assertEqual(json.loads(run("status", CAMPAIGN, "--json")[1])["journal_checked"], "as read")
        self.assertNotIn("--check-all", run("status", CAMPAIGN, "--check-all")[1])
        self.assertEqual(json.loads(run("status", CAMPAIGN, "--check-all", "--json")[1])["journal_checked"], "all")

    @unittest.skipUnless(pathlib.Path("/usr/bin/strace").exists(), "skipped, because strace is not installed")
    def test_is_read_in_a_few_pages(self):
        self.assertLess(pages_shown(), 400)

    def test_with_a_bit_changed_is_refused_where_all_is_compared(self):
        file = CAMPAIGN / "campaign.db"
        whole = file.read_bytes()
        pages = len(whole) // PAGE_BYTES
        number = pages // 2
        at = (number - 1) * PAGE_BYTES + 2000
        try:
            with open(file, "r+b") as journal:
                journal.seek(at)
                journal.write(bytes([whole[at] ^ 4]))
            words = (f"{file}: error: page {number} of {pages} does not match its checksum: a bit has changed, or another program has "
                     "written to it")
            for command in (["status", CAMPAIGN, "--check-all"], ["recompute", CAMPAIGN]):
                code, _, error = run(*command)
                self.assertNotEqual(code, 0, command)
                self.assertIn(words, error)
            self.assertEqual(run("status", CAMPAIGN)[0], 0)
        finally:
            file.write_bytes(whole)


if __name__ == "__main__":
    PROGRAM = pathlib.Path(sys.argv.pop(1)).resolve()
    with tempfile.TemporaryDirectory() as folder:
        CAMPAIGN = pathlib.Path(folder) / "long"
        long_campaign.make(PROGRAM, CAMPAIGN, CYCLES)
        unittest.main()
