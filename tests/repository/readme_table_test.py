#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the table of use in README.md from top to bottom, in a folder of its own.

  tests/repository/readme_table_test.py build/strainwave [--shorter] [TableOfUse|TableOfBenches]

The campaign is run in the background until it has been looked at and stopped, as people do, and its page until it was
fetched; everything else one after the other. Each command must end well, and never say 'nan'. What talks to the devices of
a bench, in real time, is a test of its own. With --shorter the life that a predictor learns from has fewer cycles.
"""
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.request

CHECKOUT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(sys.argv.pop(1)).resolve()
SHORTER = "--shorter" in sys.argv
CYCLES_OF_SHORTER_LIFE = 24
NOT_A_NUMBER = re.compile(r"(?<![\w/.])[-+]?nan(?![\w/.])", re.I)
INTERRUPTED = 130


def commands():
    """Those of the second column, in order."""
    use = (CHECKOUT / "README.md").read_text(encoding="utf-8").split("\n## Use\n")[1]
    table = re.search(r"\n\| to \| type \|\n\| --- \| --- \|\n((?:\|.*\n)+)", use)[1]
    return [re.fullmatch(r"\| .* \| `([^`]+)` \|", row)[1] for row in table.splitlines()]


def is_of_bench(command):
    return re.match(r"build/strainwave (bench|devices) ", command) is not None


def fill(home):
    """What the commands find where they are typed."""
    (home / "build").mkdir()
    (home / "build/strainwave").symlink_to(PROGRAM)
    (home / "bench").symlink_to(CHECKOUT / "bench")
    (home / "schedules").mkdir()
    for schedule in (CHECKOUT / "schedules").glob("*.yaml"):
        (home / "schedules" / schedule.name).symlink_to(schedule)
    if SHORTER:
        life = home / "schedules/life.yaml"
        text, replaced = re.subn(r"^cycles: \d+", f"cycles: {CYCLES_OF_SHORTER_LIFE}", life.read_text(encoding="utf-8"), flags=re.M)
        assert replaced == 1
        life.unlink()
        life.write_text(text, encoding="utf-8")


class Table(unittest.TestCase):
    def run_in(self, folder, command):
        done = subprocess.run(command, shell=True, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              check=False)
        self.assertEqual(done.returncode, 0, f"{command}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
        self.assertIsNone(NOT_A_NUMBER.search(done.stdout + done.stderr), f"{command}\n{done.stdout}{done.stderr}")
        return done.stdout

    def run_all(self, home, listed):
        for command in listed:
            # What a shorter life teaches is worth nothing, which export asks about.
            self.run_in(home, command + " --anyway" if SHORTER and " export " in command else command)


class TableOfUse(Table):
    def serve(self, folder, command):
        # At any port: the one of the table may be somebody's already.
        with subprocess.Popen(f"exec {command} --port 0", shell=True, cwd=folder, stdout=subprocess.PIPE, text=True) as page:
            address = re.search(r"http://\S+", page.stdout.readline())[0]
            with urllib.request.urlopen(address) as answer:
                self.assertIn(b"Quick stop", answer.read())
            page.send_signal(signal.SIGINT)
            self.assertEqual(page.wait(), 0)

    def test_runs_as_it_stands(self):
        listed = commands()
        self.assertGreater(len(listed), 20)
        run, status, serve, stop = listed[1:5]
        for command, verb in ((run, " run "), (status, " status "), (serve, " serve "), (stop, " stop ")):
            self.assertIn(verb, command)
        with tempfile.TemporaryDirectory() as folder:
            home = pathlib.Path(folder)
            fill(home)
            self.run_in(home, listed[0])
            with subprocess.Popen(f"exec {run}", shell=True, cwd=home, stdout=subprocess.DEVNULL,
                                  stderr=subprocess.PIPE, text=True) as campaign:
                while not (home / "campaigns/first/campaign.db").exists() and campaign.poll() is None:
                    time.sleep(0.01)  # polling another process: nothing to wait on
                self.assertIn("running in process", self.run_in(home, status))
                self.serve(home, serve)
                self.run_in(home, stop)
                said = campaign.communicate()[1]
                self.assertEqual(campaign.returncode, INTERRUPTED, said)
            self.run_all(home, [command for command in listed[5:] if not is_of_bench(command)])
            self.assertIn("14 of 14 complete", self.run_in(home, status))


class TableOfBenches(Table):
    def test_runs_as_it_stands(self):
        listed = [command for command in commands() if is_of_bench(command)]
        self.assertGreater(len(listed), 4)
        with tempfile.TemporaryDirectory() as folder:
            home = pathlib.Path(folder)
            fill(home)
            self.run_all(home, listed)
            self.assertTrue((home / "campaigns/in_process.commissioned.yaml").exists())
        self.assertEqual(list((CHECKOUT / "bench/examples").glob("*.commissioned.yaml")), [])


if __name__ == "__main__":
    unittest.main(argv=[argument for argument in sys.argv if argument != "--shorter"])
