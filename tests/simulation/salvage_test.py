#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`verify --salvage`: what is whole is written, what is lost is counted; nothing is written where that is refused.

usage: salvage_test.py PROGRAM"""
import contextlib
import json
import pathlib
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "benchmarks"))
import bit_flips  # noqa: E402
import long_campaign  # noqa: E402

PROGRAM, FOLDER = "", pathlib.Path()
PAGE_BYTES = 4096
NUMBERED = ("phases", "events", "holes", "operator_notes", "alarms", "alarm_actions", "files")
TABLES = (*NUMBERED, "campaign", "cycles", "results", "calibrations")


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def rows_of(campaign):
    with contextlib.closing(sqlite3.connect(campaign / "campaign.db")) as journal:
        return {table: set(journal.execute(f"SELECT * FROM {table}")) for table in TABLES}


class Salvage(unittest.TestCase):
    def setUp(self):
        self.campaign, self.out = FOLDER / "copy", FOLDER / "saved"
        shutil.copytree(FOLDER / "campaign", self.campaign)
        self.addCleanup(shutil.rmtree, self.campaign)
        self.addCleanup(shutil.rmtree, self.out, ignore_errors=True)

    def salvage(self, code):
        done, out, error = run("verify", self.campaign, "--salvage", self.out, "--json")
        self.assertEqual((done, error), (code, ""), out)
        return json.loads(out)["salvage"]

    def flip(self, at):
        bit_flips.flip(self.campaign / "campaign.db", 8 * at)

    def test_a_whole_campaign_is_copied(self):
        note = self.salvage(0)
        self.assertEqual((note["files_lost"], note["records_lost"], note["rows_lost"], note["cycles_incomplete"]), ([], [], {}, []))
        before, after = rows_of(self.campaign), rows_of(self.out)
        after["campaign"] = {row for row in after["campaign"] if row[0] != "salvage"}
        self.assertEqual(after, before)
        self.assertEqual(note["rows_recovered"], {table: len(rows) for table, rows in before.items()})
        for file in self.campaign.rglob("*.h5"):
            self.assertEqual((self.out / file.relative_to(self.campaign)).read_bytes(), file.read_bytes())
        self.assertEqual(run("verify", self.out)[0], 0)
        self.assertEqual(run("recompute", self.out, "--json")[1].replace(str(self.out), str(self.campaign)).partition('"warnings"')[0],
                         run("recompute", self.campaign, "--json")[1].partition('"warnings"')[0])

    def test_it_is_for_analysis(self):
        self.salvage(0)
        words = f"{self.out}: error: was salvaged from another campaign, and is for analysis (expected the folder in which the " \
                "campaign ran)\n"
        code, _, error = run("run", FOLDER / "short.yaml", "--out", self.out, "--resume")
        self.assertEqual((code, error), (2, words))
        self.assertRegex(run("status", self.out)[2], rf"^{self.out}: warning: salvaged from {self.campaign} at \S+: 0 file\(s\), "
                                                     r"0 record\(s\) and 0 row\(s\) are lost\n$")

    def test_whole_records_of_damaged_files_are_kept(self):
        file = self.campaign / "cycles" / "000001.h5"
        content = bytearray(file.read_bytes())
        content[50000] ^= 16
        file.write_bytes(content)
        (self.campaign / "cycles" / "000002.h5").unlink()
        note = self.salvage(1)
        self.assertEqual(note["files_lost"], ["cycles/000002.h5"])
        (lost,) = note["records_lost"]
        self.assertTrue(lost.startswith("cycles/000001.h5 /"), lost)
        damaged = next(one for one in json.loads(run("verify", self.campaign, "--json")[1])["files"] if one["state"] == "damaged")
        self.assertEqual(note["records_recovered"], len(damaged["records"]) - 1)
        after = json.loads(run("verify", self.out, "--json")[1])
        self.assertEqual(after["state"], "whole")
        for record in damaged["records"]:
            if record["state"] == "whole" and shutil.which("h5dump"):
                before, after = [subprocess.run(["h5dump", "-g", record["record"], "cycles/000001.h5"], cwd=place, capture_output=True,
                                       check=True).stdout for place in (self.campaign, self.out)]
                self.assertEqual(after, before)
        self.assertEqual(run("recompute", self.out)[0], 1)  # cycle 1 gives something else

    def test_every_damaged_page_costs_its_own_rows(self):
        """Whatever page it is: what is recovered was there, and of numbered rows what is lost is counted exactly."""
        before = rows_of(self.campaign)
        whole = (self.campaign / "campaign.db").read_bytes()
        pages, lost_of_all = len(whole) // PAGE_BYTES, 0
        for page in range(1, pages):
            with self.subTest(page=page + 1):
                self.flip(page * PAGE_BYTES + 1234)
                note = self.salvage(1)
                after = rows_of(self.out)
                for table in TABLES:
                    added = {row for row in after[table] - before[table] if row[0] != "salvage"}
                    self.assertFalse(added, table)
                    if table in NUMBERED:
                        self.assertEqual(note["rows_recovered"].get(table, 0) + note["rows_lost"].get(table, 0), len(before[table]),
                                         (table, note))
                lost_of_all += sum(len(before[table] - after[table]) for table in TABLES)
                incomplete = {row[0] for row in before["results"] - after["results"]}
                self.assertLessEqual(incomplete & {row[0] for row in after["cycles"]}, set(note["cycles_incomplete"]) | {0})
                self.assertEqual(run("verify", self.out)[0], 0)
                shutil.rmtree(self.out)
                (self.campaign / "campaign.db").write_bytes(whole)
        self.assertGreater(lost_of_all, 0)

    def test_rows_beyond_a_damaged_page_are_found(self):
        cycles = 3000
        self.campaign = FOLDER / "long"
        long_campaign.make(PROGRAM, self.campaign, cycles)
        with contextlib.closing(sqlite3.connect(self.campaign / "campaign.db")) as journal:
            (count,) = journal.execute("SELECT COUNT(*) FROM results").fetchone()
            (per_cycle,) = journal.execute("SELECT COUNT(*) FROM results WHERE cycle = 7").fetchone()
        for table in "results", "phases", "cycles":
            found = subprocess.run([shutil.which("sqlite3") or "false", self.campaign / "campaign.db",
                                    f"SELECT pageno FROM dbstat WHERE name = '{table}' AND pagetype = 'leaf' LIMIT 1 OFFSET 20"],
                                   capture_output=True, text=True, check=False).stdout.strip()
            if not found:
                self.skipTest("skipped, because sqlite3 is not installed, or has no dbstat")
            self.flip((int(found) - 1) * PAGE_BYTES + 1000)
            note = self.salvage(1)
            recovered = note["rows_recovered"]
            if table == "results":
                lost = count - recovered["results"]
                self.assertGreater(lost, 0)
                self.assertLessEqual(lost, PAGE_BYTES // 20 + per_cycle)
            elif table == "phases":
                self.assertGreater(note["rows_lost"]["phases"], 0)
                self.assertLessEqual(note["rows_lost"]["phases"], PAGE_BYTES // 20)
            else:
                self.assertGreaterEqual(recovered["cycles"], cycles - PAGE_BYTES // 10)
            shutil.rmtree(self.out)
            self.flip((int(found) - 1) * PAGE_BYTES + 1000)

    def test_places_that_may_not_be_written_are_refused(self):
        expected = "(expected a new or empty folder outside of the campaign)\n"
        full = FOLDER / "full"
        full.mkdir()
        (full / "of somebody else").write_text("")
        before = sorted(FOLDER.rglob("*"))
        for place, words in ((self.campaign, "is the campaign itself"), (self.campaign / "cycles" / "x", "lies within the campaign"),
                             (FOLDER, "holds the campaign"), (full, "is not empty"),
                             (full / "of somebody else", "is not a folder")):
            code, out, error = run("verify", self.campaign, "--salvage", place)
            self.assertEqual((code, out, error), (2, "", f"{place}: error: {words} {expected}"))
        self.assertEqual(sorted(FOLDER.rglob("*")), before)
        shutil.rmtree(full)


if __name__ == "__main__":
    PROGRAM = pathlib.Path(sys.argv.pop(1)).resolve()
    with tempfile.TemporaryDirectory() as folder:
        FOLDER = pathlib.Path(folder).resolve()
        made = subprocess.run([PROGRAM, "run", bit_flips.short_schedule(FOLDER), "--out", FOLDER / "campaign"], check=False,
                              capture_output=True)
        assert made.returncode == 0, made.stderr
        assert run("note", FOLDER / "campaign", "grease changed", "--by", "A. Meier")[0] == 0
        unittest.main()
