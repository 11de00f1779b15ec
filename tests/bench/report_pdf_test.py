#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave report --pdf`: printed by Chromium where it is, with the campaign's words in the PDF; and everything that it says where there is
no browser, or one that prints nothing.

usage: report_pdf_test.py PROGRAM SCHEDULE"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM, SCHEDULE = "", ""


class ReportPdf(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp())
        cls.campaign = cls.folder / "campaign"
        text = re.sub(r"(?m)^cycles: \d+", "cycles: 2", pathlib.Path(SCHEDULE).read_text())
        (cls.folder / "short.yaml").write_text(text)
        subprocess.run([PROGRAM, "run", cls.folder / "short.yaml", "--out", cls.campaign], check=True, capture_output=True)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def report(self, path, *arguments):
        scratch = self.folder / "scratch"
        shutil.rmtree(scratch, ignore_errors=True)
        scratch.mkdir()
        done = subprocess.run([PROGRAM, "report", self.campaign, "--out", self.folder / "page.html", "--pdf", self.folder / "page.pdf", *arguments],
                              capture_output=True, text=True, check=False, env=os.environ | {"PATH": str(path), "TMPDIR": str(scratch)})
        self.assertEqual(list(scratch.iterdir()), [], "something is left behind")
        return done

    def browser(self, script):
        """A folder for the PATH with gnuplot, and a chromium that is this script."""
        path = self.folder / "path"
        shutil.rmtree(path, ignore_errors=True)
        path.mkdir()
        (path / "gnuplot").symlink_to(shutil.which("gnuplot"))
        if script:
            (path / "chromium").write_text("#!/bin/sh\n" + script)
            (path / "chromium").chmod(0o755)
        return path

    def tearDown(self):
        for name in "page.html", "page.pdf":
            (self.folder / name).unlink(missing_ok=True)

    def refused(self, script, words):
        done = self.report(self.browser(script))
        self.assertEqual((done.returncode, done.stderr), (3, f"error: no PDF: {words}\n"))
        self.assertTrue((self.folder / "page.html").exists(), "the page is there nevertheless")
        self.assertFalse((self.folder / "page.pdf").exists())

    def test_without_a_browser_it_says_what_to_do(self):
        self.refused("", "there is no chromium, chromium-browser, google-chrome in the PATH (apt-get install chromium)")

    def test_a_browser_that_fails_is_quoted(self):
        self.refused("echo first >&2; echo no display >&2; exit 1\n", "chromium printed no PDF: no display")

    def test_a_browser_that_dies_is_told(self):
        self.refused("kill -9 $$\n", "chromium printed no PDF: ended by signal 9")

    def test_what_is_no_pdf_is_not_kept(self):
        self.refused('for a; do case $a in --print-to-pdf=*) echo "<html>" > "${a#*=}";; esac; done; echo printed\n', "chromium printed no PDF: printed")

    def test_another_pdf_is_replaced_and_told(self):
        (self.folder / "page.pdf").write_text("an old one")
        path = self.browser('for a; do case $a in --print-to-pdf=*) echo "%PDF-1.7 new" > "${a#*=}";; esac; done\n')
        done = self.report(path)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual((self.folder / "page.pdf").read_text(), "%PDF-1.7 new\n")
        self.assertIn(f"{self.folder}/page.pdf: the page on paper\n", done.stdout)
        self.assertEqual(json.loads(self.report(path, "--json").stdout)["pdf"], f"{self.folder}/page.pdf")

    @unittest.skipUnless(shutil.which("chromium"), "skipped, because there is no chromium (apt-get install chromium)")
    def test_chromium_prints_all_pages(self):
        done = self.report(os.environ["PATH"])
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        pdf = (self.folder / "page.pdf").read_bytes()
        self.assertTrue(pdf.startswith(b"%PDF-"))
        self.assertGreater(len(re.findall(rb"/Type ?/Page\b", pdf)), 4)


if __name__ == "__main__":
    PROGRAM, SCHEDULE = sys.argv[1:3]
    unittest.main(argv=sys.argv[:1])
