#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`verify`: what is whole, damaged, missing; the chain of hashes, computed again here from its description alone.

usage: verify_command_test.py PROGRAM"""
import contextlib
import hashlib
import json
import pathlib
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "benchmarks"))
import bit_flips  # noqa: E402
import long_campaign  # noqa: E402

PROGRAM, FOLDER = "", pathlib.Path()
# Columns of the rows that are chained, by kind, as bench/campaign/journal_chain.h has them.
CHAINED = {
    "property": ["SELECT key, value FROM campaign WHERE key = ?"],
    "cycle": ["SELECT cycle, outcome, started_s, ended_s, records_sha256 FROM cycles WHERE cycle = ?",
              "SELECT id, cycle, step, repeat, attempt, name, kind, started_s, ended_s, outcome, credited_load_s FROM phases "
              "WHERE cycle = ? ORDER BY id",
              "SELECT cycle, repeat, quantity, value, standard_error, flag FROM results WHERE cycle = ? ORDER BY repeat, quantity"],
    "event": ["SELECT id, time_s, utc, cycle, phase, severity, code, text FROM events WHERE id = ?"],
    "note": ["SELECT id, utc, author, text FROM operator_notes WHERE id = ?"],
    "file": ["SELECT id, path, bytes, sha256 FROM files WHERE id = ?"],
}


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def journal_of(campaign):
    return contextlib.closing(sqlite3.connect(campaign / "campaign.db"))


def packed(value):
    if value is None:
        return b"N"
    if isinstance(value, int):
        return b"I" + struct.pack("<q", value)
    if isinstance(value, float):
        return b"R" + struct.pack("<d", value)
    return b"T" + struct.pack("<Q", len(value.encode())) + value.encode()


class Verify(unittest.TestCase):
    def setUp(self):
        self.campaign = FOLDER / "copy"
        shutil.copytree(FOLDER / "campaign", self.campaign)
        self.addCleanup(shutil.rmtree, self.campaign)

    def verify(self, code):
        done, out, error = run("verify", self.campaign, "--json")
        self.assertEqual((done, error), (code, ""), out)
        return json.loads(out)

    def change(self, *sql):
        """Rows by another program that knows how pages are sealed."""
        with journal_of(self.campaign) as journal, journal:
            for one in sql:
                journal.execute(one)
        with journal_of(self.campaign) as journal:
            journal.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        long_campaign.seal(self.campaign / "campaign.db")

    def files_in(self, document, state):
        return [file["path"] for file in document["files"] if file["state"] == state]

    def test_a_campaign_is_whole(self):
        document = self.verify(0)
        self.assertEqual(document["state"], "whole")
        self.assertEqual(document["cycles_complete"], 3)  # the preparation among them
        on_disk = sorted(str(path.relative_to(self.campaign)) for path in self.campaign.rglob("*") if path.is_file())
        looked_at = sorted([file["path"] for file in document["files"]])
        self.assertEqual(looked_at, [path for path in on_disk if path != "lock" and not path.startswith("campaign.db")])
        self.assertEqual(self.files_in(document, "whole"), looked_at)
        code, text, _ = run("verify", self.campaign)
        self.assertEqual(code, 0)
        self.assertTrue(text.startswith(f"{self.campaign}: whole\n"), text)

    def test_the_chain_is_what_its_description_says(self):
        document = self.verify(0)
        with journal_of(self.campaign) as journal:
            link, count, seen = "0" * 64, 0, set()
            for number, kind, key, sha256 in journal.execute("SELECT number, kind, key, sha256 FROM chain ORDER BY number"):
                rows = b"".join(b"r" + b"".join(map(packed, row)) for sql in CHAINED[kind] for row in journal.execute(sql, (key,)))
                link = hashlib.sha256(link.encode() + kind.encode() + b"\0" + key.encode() + b"\0" + rows).hexdigest()
                count += 1
                self.assertEqual((number, sha256), (count, link))
                seen.add(kind)
        self.assertEqual((document["chain"]["links"], document["chain"]["head"]), (count, link))
        self.assertEqual(seen, set(CHAINED))

    def test_a_changed_row_is_one_broken_link(self):
        with journal_of(self.campaign) as journal:
            (number,) = journal.execute("SELECT number FROM chain WHERE kind = 'cycle' AND key = '1'").fetchone()
        self.change("UPDATE results SET value = value * (1 + 1e-15) WHERE cycle = 1 AND quantity = 'k2_Nm_per_rad'")
        document = self.verify(1)
        self.assertEqual(document["journal"]["state"], "whole")
        self.assertEqual(document["chain"]["broken"], [{"link": number, "what": "cycle 1", "why": "its row, or the link before "
                                                        "it, is not the one that was chained"}])
        self.assertEqual(document["counts"]["damaged"] + document["counts"]["missing"], 0)

    def test_a_row_that_is_gone_is_told(self):
        self.change("DELETE FROM operator_notes")
        broken = self.verify(1)["chain"]["broken"]
        self.assertEqual([(link["what"], link["why"]) for link in broken], [("note 1", "its row is missing")])

    def test_a_row_by_another_program_has_no_link(self):
        self.change("INSERT INTO operator_notes(utc, author, text) VALUES('2026-11-30T00:00:00.000Z', 'nobody', 'never said')")
        self.assertEqual(self.verify(1)["chain"]["unchained"], {"note": 1})
        self.assertIn("    1 row(s) of kind note have no link: they were not written by this program, or by one before it\n",
                      run("verify", self.campaign)[1])

    def test_a_chain_that_breaks_in_the_middle_is_told(self):
        self.change("DELETE FROM chain WHERE number = 5")
        broken = self.verify(1)["chain"]["broken"]
        self.assertEqual([(link["link"], link["why"]) for link in broken],
                         [(5, "it is missing"), (6, "its row, or the link before it, is not the one that was chained")])

    def test_damaged_records_are_named(self):
        file = self.campaign / "cycles" / "000001.h5"
        content = bytearray(file.read_bytes())
        content[50000] ^= 16
        file.write_bytes(content)
        (self.campaign / "cycles" / "000002.h5").unlink()
        document = self.verify(1)
        self.assertEqual(self.files_in(document, "missing"), ["cycles/000002.h5"])
        (damaged,) = [one for one in document["files"] if one["state"] == "damaged"]
        self.assertEqual((damaged["path"], damaged["cycle"], damaged["reason"]),
                         ("cycles/000001.h5", 1, "it is not the file that was registered (SHA-256)"))
        states = [record["state"] for record in damaged["records"]]
        self.assertEqual(sorted(set(states)), ["damaged", "whole"])
        self.assertEqual(states.count("damaged"), 1)
        text = run("verify", self.campaign)[1]
        self.assertIn("  missing      cycles/000002.h5 (cycle 2): it is not there\n", text)
        self.assertIn("  damaged      cycles/000001.h5 (cycle 1): it is not the file that was registered (SHA-256)\n", text)

    def test_without_a_journal_files_are_looked_at_alone(self):
        (self.campaign / "campaign.db").unlink()
        document = self.verify(1)
        self.assertEqual(document["journal"]["state"], "missing")
        self.assertIn("cycles/000001.h5", self.files_in(document, "unregistered"))

    def test_what_is_no_campaign_is_refused(self):
        foreign = FOLDER / "foreign"
        foreign.mkdir()
        self.addCleanup(foreign.rmdir)
        self.assertEqual(run("verify", foreign), (2, "", f"{foreign}: error: not a campaign (expected a folder with schedule.yaml, "
                                                         "bench.yaml and campaign.db)\n"))

    def test_a_newer_journal_is_refused(self):
        self.change("PRAGMA user_version=3")
        self.assertEqual(run("verify", self.campaign), (2, "", f"{self.campaign / 'campaign.db'}: error: journal version 3 "
                                                               "(expected 1 or 2)\n"))

    def test_nothing_is_left(self):
        for path in self.campaign.rglob("*"):
            if path.is_file() and path.name != "schedule.yaml":
                path.unlink()
        (self.campaign / "schedule.yaml").unlink()
        (self.campaign / "cycles" / "000001.h5").write_bytes(b"no records")
        self.assertEqual(self.verify(2)["state"], "nothing can be read")

    def test_a_journal_of_an_earlier_version_gets_its_chain_when_it_is_written_to(self):
        self.change("DROP TABLE chain", "DROP TABLE files")
        document = self.verify(0)
        self.assertEqual(document["chain"], {"state": "none"})
        self.assertTrue(self.files_in(document, "unregistered"))
        self.assertEqual(run("note", self.campaign, "later", "--by", "B. Kurz")[0], 0)
        document = self.verify(0)
        with journal_of(self.campaign) as journal:
            (events,) = journal.execute("SELECT COUNT(*) FROM chain WHERE kind = 'event'").fetchone()
            self.assertEqual(journal.execute("SELECT COUNT(*) FROM events").fetchone(), (events,))
        self.assertGreater(events, 0)


if __name__ == "__main__":
    PROGRAM = pathlib.Path(sys.argv.pop(1)).resolve()
    with tempfile.TemporaryDirectory() as folder:
        FOLDER = pathlib.Path(folder)
        made = subprocess.run([PROGRAM, "run", bit_flips.short_schedule(FOLDER), "--out", FOLDER / "campaign"], check=False,
                              capture_output=True)
        assert made.returncode == 0, made.stderr
        assert run("note", FOLDER / "campaign", "grease changed", "--by", "A. Meier")[0] == 0
        unittest.main()
