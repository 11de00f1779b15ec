#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A finished campaign on a read-only medium, looked at by somebody who owns nothing of it: every command that reads it gives
what it gives elsewhere, writes to another folder, and says what it could not keep; SQLite opens the journal.

usage: read_only_medium_test.py PROGRAM     exit code 77: skipped, nothing can be mounted here, or there is no sqlite3"""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "bench" / "peers"))
import needed  # noqa: E402

with needed.peers("/usr/bin/sqlite3", "/usr/bin/setpriv"):
    import exported_campaign

PROGRAM = ""
SMALL = pathlib.Path(__file__).resolve().parent / "small.yaml"
MOUNTED = 'mount --bind "$0" "$0"; mount -o remount,ro,bind "$0"; exec setpriv --reuid=65534 --regid=65534 --clear-groups "$@"'
PYTHON = "import sqlite3, sys; print(sqlite3.connect(sys.argv[1], uri=True).execute('SELECT COUNT(*) FROM cycles').fetchone())"


def on_read_only_medium(campaign, *command):
    return subprocess.run(["unshare", "--mount", "sh", "-ec", MOUNTED, str(campaign), *map(str, command)], capture_output=True,
                          text=True, check=False, cwd="/")


class ReadOnlyMedium(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = pathlib.Path(scratch.name)
        cls.folder.chmod(0o755)
        cls.program = cls.folder / "strainwave"  # where everybody may run it
        shutil.copy(PROGRAM, cls.program)
        cls.campaign, _ = exported_campaign.make(PROGRAM, cls.folder)
        (cls.campaign / "features.h5").unlink()
        cls.file = cls.campaign / "cycles/000003.h5"

    def own(self, name):
        """A folder in which anybody may write."""
        folder = self.folder / name
        folder.mkdir()
        folder.chmod(0o777)
        self.addCleanup(shutil.rmtree, folder)
        return folder

    def read(self, *arguments):
        done = on_read_only_medium(self.campaign, self.program, *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def same(self, *arguments, changing=()):
        """What a command says in JSON, which is what it says where the campaign can be written to, but for what changes."""
        here = subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, check=True)
        there = self.read(*arguments)
        said, expected = json.loads(there.stdout), json.loads(here.stdout)
        for key in changing:
            said.pop(key), expected.pop(key)
        self.assertEqual(said, expected)
        self.assertEqual(there.stderr, here.stderr)
        return said

    def test_nobody_can_write_there(self):
        self.assertNotEqual(on_read_only_medium(self.campaign, "touch", self.campaign / "x").returncode, 0)

    def test_status_alarms_and_recompute(self):
        self.assertEqual(self.same("status", self.campaign, "--json", changing=("disk",))["cycles_complete"], 25)
        self.same("alarms", self.campaign, "--json")
        self.assertEqual(self.same("recompute", self.campaign, "--json")["cycles_equal_to_stored"], 26)
        self.same("recompute", self.file, "--json")

    def test_features_say_that_they_are_not_kept(self):
        first = self.read("features", self.campaign)
        said = ("the features are not kept and are computed anew each time: cannot create "
                f"'{self.campaign}/.features.h5.partial': Read-only file system")
        self.assertEqual(first.stderr, f"{self.campaign}: warning: {said}\n")
        self.assertEqual(first.stdout, f"{self.campaign}: 1225 features of 25 cycles\n")
        report = json.loads(self.read("features", self.campaign, "--json").stdout)
        self.assertEqual(report["warnings"], [said])
        self.assertFalse((self.campaign / "features.h5").exists())

    def test_what_writes_elsewhere(self):
        out, here = self.own("there"), self.own("here")
        commands = {"t.csv": ("table", self.campaign), "loop.mat": ("convert", self.file, "--group", "hysteresis_1"),
                    "predictor": ("train", self.campaign, "--epochs", 3), "diagnosis": ("diagnose", self.campaign),
                    "of_one": ("diagnose", self.file, "--group", "transmission_error")}
        for name, arguments in commands.items():
            self.read(*arguments, "--out", out / name)
            subprocess.run([self.program, *map(str, arguments), "--out", here / name], check=True, capture_output=True)
        (self.campaign / "features.h5").unlink()
        for name in ("t.csv", "predictor/numbers.h5"):
            self.assertEqual((out / name).read_bytes(), (here / name).read_bytes(), name)
        for name in ("loop.mat", "diagnosis/diagnosis.json", "of_one/diagnosis.json"):
            self.assertGreater((out / name).stat().st_size, 1000, name)
        self.assertIn("hysteresis", self.read("convert", self.file, "--preview").stdout)

    def test_sqlite_opens_the_journal(self):
        fresh = self.folder / "fresh"  # as a run leaves it; a command that reads might have left files of SQLite since
        subprocess.run([self.program, "run", SMALL, "--out", fresh], check=True, capture_output=True)
        self.addCleanup(shutil.rmtree, fresh)
        journal = fresh / "campaign.db"

        def asked(*command):
            done = on_read_only_medium(fresh, *command)
            self.assertEqual(done.returncode, 0, done.stderr)
            return done.stdout

        for how in ([journal], ["-readonly", journal], [f"file:{journal}?mode=ro"]):
            self.assertEqual(asked("sqlite3", *how, "SELECT COUNT(*) FROM cycles"), "4\n", how)
        self.assertIn("operator_notes", asked("sqlite3", journal, ".tables"))
        self.assertEqual(asked("/usr/bin/python3", "-c", PYTHON, f"file:{journal}?mode=ro"), "(4,)\n")

    def test_what_would_change_the_campaign_is_refused_with_the_reason(self):
        done = on_read_only_medium(self.campaign, self.program, "note", self.campaign, "x", "--by", "me")
        self.assertEqual(done.returncode, 3)
        self.assertEqual(done.stderr, f"{self.campaign}/campaign.db: error: attempt to write a readonly database\n")


if __name__ == "__main__":
    PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    with tempfile.TemporaryDirectory() as tried:
        if on_read_only_medium(tried, "true").returncode != 0:
            print("skipped, because this machine lets no test mount a file system")
            sys.exit(needed.SKIPPED)
    unittest.main()
