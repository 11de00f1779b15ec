#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave report` as a user calls it: the page parsed by html.parser and held against what SQLite itself reads of the
journal, foreign text in it, the same bytes twice, and everything that it says of bad input, whole.

usage: report_command_test.py PROGRAM SCHEDULE"""
import csv
import html.parser
import json
import pathlib
import re
import shutil
import sqlite3
import statistics
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib

PROGRAM, SCHEDULE = "", ""
HOSTILE = "<script>alert(1)</script> & \"grease\", it's\u202enew"
HOSTILE_NAME = "A. <b>Meier</b>"
VOID = {"meta", "br", "img", "link", "hr"}


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def seal(path):
    """Checksums in every page, as bench/campaign/page_checksums.h says."""
    content = bytearray(path.read_bytes())
    for number in range(len(content) // 4096):
        crc = zlib.crc32(content[4096 * number:4096 * number + 4088], zlib.crc32(struct.pack("<I", number + 1)))
        content[4096 * number + 4088:4096 * number + 4096] = struct.pack("<II", crc, crc ^ 0xFFFFFFFF)
    path.write_bytes(content)


class Page(html.parser.HTMLParser):
    """Headings, tables by their first head cells, elements; every element is closed where it was opened."""
    def __init__(self, text):
        super().__init__()
        self.open, self.elements, self.attributes, self.headings, self.tables, self.svgs = [], [], [], [], [], []
        self.cell = None
        self.words = []
        self.feed(text)
        self.close()
        assert not self.open, self.open

    def handle_starttag(self, tag, attrs):
        self.elements.append(tag)
        self.attributes += attrs
        if tag not in VOID:
            self.open.append(tag)
        if tag == "table":
            self.tables.append([])
        if tag == "tr" and "table" in self.open:
            self.tables[-1].append([])
        if tag in ("td", "th", "h1", "h2", "p", "text"):
            self.cell = ""
        if tag == "svg":
            self.svgs.append([])

    def handle_startendtag(self, tag, attrs):
        self.elements.append(tag)
        self.attributes += attrs

    def handle_data(self, data):
        if self.cell is not None:
            self.cell += data

    def handle_endtag(self, tag):
        assert self.open and self.open[-1] == tag, (tag, self.open[-5:])
        self.open.pop()
        if tag in ("td", "th"):
            self.tables[-1][-1].append(self.cell)
        elif tag in ("h1", "h2"):
            self.headings.append(self.cell)
        elif tag == "p":
            self.words.append(self.cell)
        elif tag == "text" and self.svgs:
            self.svgs[-1].append(self.cell.strip())
        if tag in ("td", "th", "h1", "h2", "p", "text"):
            self.cell = None

    def table(self, *heads):
        """The rows of the first table whose heads begin so."""
        for table in self.tables:
            if tuple(table[0][:len(heads)]) == heads:
                return table[1:]
        raise AssertionError((heads, [table[0] for table in self.tables]))


def number(cell):
    """Value and half width of "16020 ± 69", with an asterisk or without."""
    value, _, half_width = cell.rstrip(" *").partition(" ± ")
    return float(value), float(half_width) if half_width else 0.0


class Report(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.folder = pathlib.Path(cls.scratch.name)
        text = pathlib.Path(SCHEDULE).read_text().replace("cycles: 12", "cycles: 10").replace("duration: 1 min", "duration: 5 s")
        text = text.replace("steps: 360", "steps: 72").replace("step: 1 deg", "step: 5 deg").replace("SIM-0001", "SIM <i>&1")
        text = text.replace("\nmeasurements:", "\nstop:\n  k2_below_share_of_first: 80 %\n  e_max_above: 3 arcmin\n\nmeasurements:")
        cls.schedule = cls.folder / "schedule.yaml"
        cls.schedule.write_text(text)
        code, _, told = run("run", cls.schedule, "--out", cls.folder / "c")
        assert code == 0, told
        code, _, told = run("note", cls.folder / "c", HOSTILE, "--by", HOSTILE_NAME)
        assert code == 0, told
        code, cls.said, cls.told = run("report", cls.folder / "c", "--out", cls.folder / "r.html", "--csv", cls.folder / "tables")
        assert code == 0, cls.told
        cls.text = (cls.folder / "r.html").read_text()
        cls.page = Page(cls.text)

    def journal(self, question):
        journal = sqlite3.connect(f"file:{self.folder / 'c/campaign.db'}?mode=ro", uri=True)
        try:
            return journal.execute(question).fetchall()
        finally:
            journal.close()

    def csv(self, name, folder="tables"):
        with (self.folder / folder / name).open(newline="") as file:
            return list(csv.reader(file))

    @staticmethod
    def is_loading(file):
        journal = sqlite3.connect(f"file:{file}?mode=ro", uri=True)
        try:
            return bool(journal.execute("SELECT 1 FROM phases WHERE cycle = 1 AND kind = 'load_run' AND outcome = 'running'").fetchone())
        finally:
            journal.close()

    def results(self, quantity):
        return {cycle: (value, error) for cycle, value, error in self.journal(
            f"SELECT cycle, value, standard_error FROM results WHERE quantity = '{quantity}' AND repeat = 0 AND cycle > 0")}

    def test_says_what_it_wrote(self):
        self.assertEqual(self.told, "")
        self.assertRegex(self.said, r"\A\S*r\.html: 1 campaign, 21 sections, \d+\.\d [kM]B\n\S*tables: 1\d tables as CSV\n\Z")

    def test_loads_nothing_and_runs_nothing(self):
        self.assertNotRegex(self.text, r"https?:")
        self.assertNotIn("script", self.page.elements)
        self.assertNotIn("link", self.page.elements)
        for name, value in self.page.attributes:
            self.assertFalse(name.startswith("on"), (name, value))
            if name in ("src", "href", "xlink:href"):
                self.assertTrue(value.startswith("#"), (name, value))
        self.assertNotIn("@import", self.text)
        self.assertNotIn("url(", self.text.replace("url(#", ""))

    def test_every_section_is_there(self):
        self.assertEqual(self.page.headings, [
            "Life test of SIM <i>&1: c", "Specimen, bench and version", "Schedule", "What has changed", "Trends",
            "Results over cycles", "First and last measurement", "Load that really ran", "Stop criteria, and when they will be met", "Sensor checks",
            "Calibrations", "People and notes", "Interruptions, and the rule that makes it one test",
            "What could have been lost, and was not", "Samples lost", "Alarms", "Events", "Trail of acts, edits and notes",
            "Whether it is still what was written", "Fault and trip tests", "Diagnosis", "Predictor"])

    def test_what_there_is_none_of_is_said(self):
        for words in ("No alarm was ever raised.", "It was never interrupted.", "The schedule checks no sensor.",
                      "No source of this bench counts its samples."):
            self.assertIn(words, self.page.words)

    def test_subject_has_version_and_hashes(self):
        subject = dict(self.page.table("what", "is"))
        of_journal = dict(self.journal("SELECT * FROM campaign"))
        self.assertEqual(subject["SHA-256 of the schedule"], of_journal["schedule_sha256"])
        self.assertEqual(subject["SHA-256 of the bench file"], of_journal["bench_sha256"])
        self.assertEqual(subject["SHA-256 of the plant file"], "none")
        self.assertEqual(subject["begun"], of_journal["started_utc"])
        self.assertEqual(subject["cycles complete"], "10 of 10")
        self.assertIn(subject["software"], [text for (text,) in self.journal("SELECT text FROM events WHERE code = 'software'")])

    def test_results_are_those_of_the_journal(self):
        found = 0
        for name, head in (("k1_Nm_per_rad", "K₁ (Nm/rad)"), ("e_max_arcmin", "e max (arcmin)")):
            for table in self.page.tables:
                if table[0][0] != "cycle" or head not in table[0]:
                    continue
                column = table[0].index(head)
                for row in table[1:]:
                    value, error = self.results(name)[int(row[0])]
                    shown, half_width = number(row[column])
                    self.assertAlmostEqual(shown / value, 1.0, 2, (name, row))
                    self.assertAlmostEqual(half_width / (1.96 * error), 1.0, 1, (name, row))
                    found += 1
        self.assertEqual(found, 20)

    def test_changes_are_first_and_last_beside_the_gauge(self):
        changes = {row[0]: row for row in self.page.table("quantity", "first", "last", "change")}
        k1 = self.results("k1_Nm_per_rad")
        row = changes["K₁ (Nm/rad)"]
        change, half_width = number(row[3])
        self.assertLess(abs(change - (k1[10][0] - k1[1][0])), 2.0)
        self.assertAlmostEqual(half_width / (1.96 * (k1[1][1] ** 2 + k1[10][1] ** 2) ** 0.5), 1.0, 1)
        (limit,), = self.journal("SELECT value FROM calibrations WHERE name = 'limit_95_k1_Nm_per_rad'")
        self.assertAlmostEqual(float(row[4]) / limit, 1.0, 2)
        self.assertEqual(row[5], "larger than the gauge" if abs(k1[10][0] - k1[1][0]) > limit else "within the gauge")
        values = [k1[cycle][0] for cycle in range(1, 11)]
        moving = statistics.mean(abs(b - a) for a, b in zip(values, values[1:], strict=False))
        lower, upper = map(float, row[6].split(" to "))
        self.assertAlmostEqual(lower / (statistics.mean(values) - 2.66 * moving), 1.0, 3)
        self.assertAlmostEqual(upper / (statistics.mean(values) + 2.66 * moving), 1.0, 3)

    def test_pictures_are_inline(self):
        texts = [" ".join(texts) for texts in self.page.svgs]
        self.assertEqual(sum("K₁ (Nm/rad)" in text for text in texts), 1)
        self.assertTrue(any("order" in text for text in texts))
        self.assertGreaterEqual(len(texts), 5)
        self.assertTrue(any("SIM <i>&1" in text for text in texts))

    def test_orders_are_those_of_the_wave_generator(self):
        orders = self.page.table("order of the output", "order of the input")
        self.assertIn("160", [row[0] for row in orders])
        self.assertTrue(any("wave generator" in row[2] for row in orders))

    def test_stop_criteria_are_those_of_life(self):
        code, said, told = run("life", self.folder / "c", "--level", "95", "--json")
        self.assertEqual(code, 0, told)
        limits = {limit["quantity"]: limit for limit in json.loads(said)["campaigns"][0]["limits"]}
        rows = {row[0]: row for row in self.page.table("quantity", "first", "now", "limit", "met at")}
        self.assertEqual(len(rows), len(limits))
        for name, head in (("k2_Nm_per_rad", "K₂ (Nm/rad)"),):
            self.assertAlmostEqual(float(rows[head][3]) / limits[name]["limit"], 1.0, 4)
            self.assertEqual("no forecast" in rows[head][4], not limits[name]["approached"])
        self.assertIn("It ends when K2 is below 80 % of its first value.", self.page.words)

    def test_foreign_text_stays_text(self):
        shown = HOSTILE.replace("\u202e", "\\u202e")
        self.assertEqual([row[1:] for row in self.page.table("UTC", "who", "note")], [[HOSTILE_NAME, shown]])
        self.assertIn("&lt;script&gt;alert(1)&lt;/script&gt; &amp; &quot;grease&quot;, it&#39;s", self.text)
        for name in ("script", "b", "i"):
            self.assertNotIn(name, self.page.elements)

    def test_verify_is_told_in_a_line(self):
        code, said, _ = run("verify", self.folder / "c", "--json")
        self.assertEqual(code, 0)
        verified = json.loads(said)
        self.assertIn(f"strainwave verify: whole: journal whole, chain of {verified['chain']['links']} links whole, head "
                      f"{verified['chain']['head']}, 11 complete cycles; files: {verified['counts']['whole']} whole, 0 damaged, 0 "
                      "missing.", self.page.words)

    def test_the_bearings_life_is_that_of_the_equivalent_time(self):
        (equivalent_s,), = self.journal("SELECT SUM(value) FROM results WHERE quantity = 'load_run_equivalent_s'")
        row, = self.page.table("load run", "runs")
        self.assertEqual((row[0], row[1], row[3]), ("load_run", "10", "10"))
        # 40 Nm and 2400 rpm beside 34 Nm, 2000 rpm and 7000 h.
        self.assertAlmostEqual(float(row[4]) / (100 * equivalent_s / 7000 / 3600 * (40 / 34) ** 3 * 2400 / 2000), 1.0, 3)
        self.assertLess(abs(float(row[2]) / float(row[4]) - 1), 0.2)

    def test_ranges_of_the_torque_are_those_of_the_plan(self):
        rows = self.page.table("range from (Nm)", "to (Nm)")
        reversals = next(row for row in rows if row[0] == "80")
        cycles, planned = float(reversals[2]), float(reversals[5])
        # Ten load runs of 5 s, a way of 80 turns at 40 in a second: three ways, so there and back once.
        self.assertAlmostEqual(cycles, 10, delta=1)
        self.assertAlmostEqual(planned, 10, delta=1)
        loops = next(row for row in rows if row[0] == "65")
        # Both lock angles of ten cycles and five repeats, without the blank test; rows in the wrong order would be ranges of their own.
        self.assertEqual((loops[2], loops[5]), ("30.0", "30.0"))
        self.assertEqual([row for row in rows if 10 <= float(row[0]) < 30], [])
        for row in rows:
            if float(row[2]) > 0:
                self.assertLess(abs(float(row[3])), 42)
        self.assertTrue(any("counted as rainflow (ASTM E1049-85) over 11 cycle file(s)" in words for words in self.page.words))

    def test_the_trail_has_each_act_with_its_link(self):
        rows = self.page.table("link", "UTC", "who", "kind")
        links = self.journal("SELECT number, kind, sha256 FROM chain WHERE kind NOT IN ('cycle', 'file') ORDER BY number")
        self.assertEqual([(int(row[0]), row[3], row[5]) for row in rows], [(link[0], link[1], link[2][:12]) for link in links])
        self.assertTrue(all(row[6] == "yes" for row in rows))
        note = next(row for row in rows if row[3] == "note")
        self.assertEqual((note[2], note[4]), (HOSTILE_NAME, HOSTILE.replace("\u202e", "\\u202e")))
        (count, head), = self.journal("SELECT number, sha256 FROM chain ORDER BY number DESC LIMIT 1")
        self.assertTrue(any(f"The chain holds: {count} links were computed again, the last is {head}." in words for words in self.page.words))

    def test_a_changed_note_breaks_the_chain(self):
        shutil.copytree(self.folder / "c", self.folder / "forged")
        with sqlite3.connect(self.folder / "forged/campaign.db") as journal:
            journal.execute("UPDATE operator_notes SET author = 'B. Meier'")
        journal.close()
        seal(self.folder / "forged/campaign.db")
        code, _, told = run("report", self.folder / "forged", "--out", self.folder / "f.html")
        self.assertEqual(code, 0, told)
        page = Page((self.folder / "f.html").read_text())
        note = next(row for row in page.table("link", "UTC", "who", "kind") if row[3] == "note")
        self.assertEqual((note[2], note[6]), ("B. Meier", "no: its row, or the link before it, is not the one that was chained"))
        self.assertTrue(any("The chain does not hold: 1 of " in words for words in page.words))

    def test_what_was_not_lost_is_told(self):
        for words in ("The program has watched the bench from the first cycle to the last event.", "No phase was cut.",
                      "Of 11 cycles, the preparation among them, 11 raw files are whole and none is lost."):
            self.assertIn(words, self.page.words)

    def test_a_cut_is_told_with_what_was_kept(self):
        cut = self.folder / "cut"
        schedule = self.folder / "cut.yaml"
        schedule.write_text(self.schedule.read_text().replace("cycles: 10", "cycles: 1").replace("duration: 5 s", "duration: 20 min"))
        with subprocess.Popen([PROGRAM, "run", schedule, "--out", cut, "--pace", "400"], stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL) as ran:
            checkpoints = set()
            while ran.poll() is None and len(checkpoints) < 3:  # while load is served
                if (cut / "checkpoint").exists() and self.is_loading(cut / "campaign.db"):
                    checkpoints.add((cut / "checkpoint").read_bytes())
                time.sleep(0.01)
            ran.kill()
        code, _, told = run("run", schedule, "--out", cut, "--resume", "--accept-pause")
        self.assertEqual(code, 0, told)
        code, _, told = run("report", cut, "--out", self.folder / "cut.html")
        self.assertEqual(code, 0, told)
        page = Page((self.folder / "cut.html").read_text())
        self.assertIn("The bench was out of the program's sight once: see the interruptions.", page.words)
        self.assertTrue(any(re.match(r"Cut were 1 load run\(s\) and 0 other phase\(s\)\. Of the load runs .* of load were kept and not run "
                                     r"again; .* 1 cycle\(s\) in which that happened 1 are complete\.", words) for words in page.words), page.words)
        self.assertTrue(any(row[3] == "hole" for row in page.table("link", "UTC", "who", "kind")))

    def test_damage_is_told_and_the_rest_shown(self):
        shutil.copytree(self.folder / "c", self.folder / "damaged")
        file = self.folder / "damaged/cycles/000001.h5"
        content = bytearray(file.read_bytes())
        content[len(content) // 2] ^= 255
        file.write_bytes(content)
        code, _, told = run("report", self.folder / "damaged", "--out", self.folder / "d.html")
        self.assertEqual(code, 0)
        self.assertIn("warning: no loops and no error over a turn: ", told)
        page = Page((self.folder / "d.html").read_text())
        self.assertTrue(any(re.search(r"strainwave verify: damaged: .* 1 damaged, 0 missing\.", words) for words in page.words))

    def test_csv_has_the_same_numbers(self):
        self.assertEqual(sorted(path.name for path in (self.folder / "tables").iterdir()), [
            "calibrations.csv", "changes.csv", "cycles.csv", "events.csv", "load_life.csv", "load_ranges.csv", "notes.csv", "orders.csv",
            "people.csv", "schedule.csv", "stop_criteria.csv", "subject.csv", "trail.csv"])
        run("table", self.folder / "c", "--out", self.folder / "t.csv")
        self.assertEqual((self.folder / "tables/cycles.csv").read_bytes(), (self.folder / "t.csv").read_bytes())
        self.assertEqual(self.csv("changes.csv")[1:], self.page.table("quantity", "first", "last", "change"))
        self.assertEqual(self.csv("notes.csv")[1][1:], [HOSTILE_NAME, HOSTILE])

    def test_the_same_campaign_gives_the_same_bytes(self):
        for name in ("again.html", "c/inside.html", "again.html"):
            code, _, told = run("report", self.folder / "c", "--out", self.folder / name)
            self.assertEqual(code, 0, told)
            self.assertEqual((self.folder / name).read_bytes(), (self.folder / "r.html").read_bytes())
        (self.folder / "c/inside.html").unlink()

    def test_two_campaigns_are_laid_over_each_other(self):
        shutil.copytree(self.folder / "c", self.folder / "second")
        code, said, told = run("report", self.folder / "c", self.folder / "second", "--out", self.folder / "two.html", "--csv",
                               self.folder / "both", "--json")
        self.assertEqual(code, 0, told)
        self.assertEqual(json.loads(said)["bytes"], (self.folder / "two.html").stat().st_size)
        page = Page((self.folder / "two.html").read_text())
        self.assertEqual(page.headings[:3], ["Life tests: 2 campaigns", "Beside each other", "1 c: Specimen, bench and version"])
        self.assertIn("2 second: Events", page.headings)
        differences = {row[0]: row for row in page.table("quantity", "1 c", "2 second less 1 c")}
        self.assertEqual(number(differences["K₁ (Nm/rad)"][2])[0], 0.0)
        self.assertEqual((self.folder / "both/2_cycles.csv").read_bytes(), (self.folder / "tables/cycles.csv").read_bytes())

    def test_bad_input_is_told_whole(self):
        none = self.folder / "none"
        self.assertEqual(run("report", none, "--out", self.folder / "x.html"), (
            2, "", f"{none}: error: not a campaign (expected a folder with schedule.yaml, bench.yaml and campaign.db)\n"))
        empty = self.folder / "empty"
        empty.mkdir(exist_ok=True)
        self.assertEqual(run("report", empty, "--out", self.folder / "x.html"), (
            2, "", f"{empty}: error: not a campaign (expected a folder with schedule.yaml, bench.yaml and campaign.db)\n"))
        self.assertFalse((self.folder / "x.html").exists())
        code, _, told = run("report", self.folder / "c")
        self.assertEqual((code, told.splitlines()[0]), (2, "--out is required"))

    def test_a_campaign_without_a_complete_cycle_is_refused(self):
        fresh = self.folder / "fresh"
        with subprocess.Popen([PROGRAM, "run", self.schedule, "--out", fresh], stdout=subprocess.PIPE, stderr=subprocess.STDOUT) as ran:
            while not (fresh / "checkpoint").exists() and ran.poll() is None:
                time.sleep(0.01)
            ran.terminate()
            ran.communicate()
        code, said, told = run("report", fresh, "--out", self.folder / "x.html")
        self.assertEqual((code, said), (2, ""), told)
        self.assertTrue(told.endswith(f"{fresh}: error: has no complete cycle yet (expected one at least; strainwave status shows how "
                                      "far it is)\n"), told)


if __name__ == "__main__":
    PROGRAM, SCHEDULE = sys.argv.pop(1), sys.argv.pop(1)
    unittest.main()
