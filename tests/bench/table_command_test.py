#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave table` against what SQLite itself reads of the journal.

usage: table_command_test.py PROGRAM SCHEDULE"""
import csv
import json
import pathlib
import sqlite3
import subprocess
import sys
import tempfile
import unittest

PROGRAM, SCHEDULE = "", ""


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


class Table(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.folder = pathlib.Path(cls.scratch.name)
        code, _, told = run("run", SCHEDULE, "--out", cls.folder / "c")
        assert code == 0, told

    def test_every_result_of_every_cycle_is_there_with_its_error(self):
        out = self.folder / "t.csv"
        code, said, told = run("table", self.folder / "c", "--out", out, "--json")
        self.assertEqual(code, 0, told)
        with out.open(newline="") as file:
            rows = list(csv.DictReader(file))
        journal = sqlite3.connect(f"file:{self.folder / 'c/campaign.db'}?mode=ro", uri=True)
        results = journal.execute("SELECT r.cycle, quantity, value, standard_error FROM results r JOIN cycles c ON c.cycle = r.cycle "
                                  "WHERE repeat = 0 AND c.outcome = 'complete' AND r.cycle > 0").fetchall()
        journal.close()
        self.assertGreater(len(results), 50)
        by_cycle = {int(row["cycle"]): row for row in rows}
        for cycle, quantity, value, error in results:
            for name, expected in ((quantity, value), (quantity + "_se", error)):
                cell = by_cycle[cycle][name]
                self.assertEqual(float(cell) if cell else None, expected, (cycle, name))
        self.assertEqual(json.loads(said)["rows"], len(rows))
        self.assertEqual([int(row["cycle"]) for row in rows], list(range(1, len(rows) + 1)))
        self.assertTrue(all(float(a["load_h"]) < float(b["load_h"]) for a, b in zip(rows, rows[1:], strict=False)))

    def test_no_campaign_and_no_cycle(self):
        code, _, told = run("table", self.folder / "none", "--out", self.folder / "x.csv")
        self.assertEqual(code, 2)
        self.assertFalse((self.folder / "x.csv").exists())


if __name__ == "__main__":
    PROGRAM, SCHEDULE = sys.argv.pop(1), sys.argv.pop(1)
    unittest.main()
