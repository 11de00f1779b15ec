#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What a program calls itself, by cmake/software.cmake in checkouts of its own.

  tests/packaging/software_test.py CMAKE
"""
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

CMAKE = sys.argv.pop(1)
SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "cmake/software.cmake"


class Software(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.checkout = pathlib.Path(folder.name) / "checkout"
        self.checkout.mkdir()
        self.source = pathlib.Path(folder.name) / "software.cc"

    def git(self, *arguments):
        return subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@b", *arguments], cwd=self.checkout,
                              check=True, capture_output=True, text=True).stdout.strip()

    def commit(self, text):
        (self.checkout / "file").write_text(text, encoding="utf-8")
        self.git("add", "file")
        self.git("commit", "--quiet", "-m", text)
        return self.git("rev-parse", "--short", "HEAD")

    def said(self, checkout=None):
        subprocess.run([CMAKE, "-D", f"SOFTWARE_CHECKOUT={checkout or self.checkout}", "-D", "SOFTWARE_VERSION=4.5.6",
                        "-D", "SOFTWARE_GIT=git", "-D", f"SOFTWARE_SOURCE={self.source}", "-P", SCRIPT], check=True)
        return re.search(r'Software\(\) \{ return "(.*)"; \}', self.source.read_text(encoding="utf-8"))[1]

    def test_has_the_commit_and_says_where_files_differ_from_it(self):
        self.git("init", "--quiet")
        first = self.commit("one")
        self.assertEqual(self.said(), f"strainwave 4.5.6 ({first})")
        (self.checkout / "file").write_text("changed", encoding="utf-8")
        self.assertEqual(self.said(), f"strainwave 4.5.6 ({first}-dirty)")
        second = self.commit("two")
        self.git("tag", "v9")  # is no commit
        self.assertNotEqual(second, first)
        self.assertEqual(self.said(), f"strainwave 4.5.6 ({second})")

    def test_is_written_anew_only_where_it_changes(self):
        self.git("init", "--quiet")
        self.commit("one")
        self.said()
        before = self.source.stat()
        self.said()
        self.assertEqual(self.source.stat().st_mtime_ns, before.st_mtime_ns)

    def test_is_the_version_alone_outside_of_a_checkout_and_within_that_of_another(self):
        self.assertEqual(self.said(), "strainwave 4.5.6")
        self.git("init", "--quiet")
        self.commit("one")
        archive = self.checkout / "unpacked"
        archive.mkdir()
        self.assertEqual(self.said(archive), "strainwave 4.5.6")


if __name__ == "__main__":
    unittest.main()
