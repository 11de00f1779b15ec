#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Answers that a fleet has collected are scored as those of the program itself.

usage: answers_test.py PROGRAM"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM = ""
CASES = ["--seed", "3", "--cases", "4", "--kind", "hysteresis", "--most-samples", "3000"]
OF_THE_MACHINE = ("wall_s", "cpu_s", "peak_rss_MB")


class Answers(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def call(self, *command, code=0):
        done = subprocess.run([*map(str, command)], cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, code, (command, done.stdout, done.stderr))
        return done.stderr

    def blind(self, *arguments, code=0):
        return self.call(sys.executable, "-B", pathlib.Path(__file__).resolve().with_name("run"), *CASES, *arguments, code=code)

    def results(self, out):
        rows = [json.loads(line) for line in (self.folder / out / "results.jsonl").read_text().splitlines()]
        return [{key: value for key, value in row.items() if key not in OF_THE_MACHINE} for row in rows]

    def test_of_a_fleet_get_the_same_marks(self):
        self.blind("--program", PROGRAM, "--out", "one")
        self.blind("--generate-only", "--out", "many")
        self.call(PROGRAM, "fleet", "submit", "diagnose", "many/records", "--out", "plan", "--local")
        self.call(PROGRAM, "fleet", "collect", "plan", "--out", "answers.json")
        self.blind("--out", "many", "--answers", "answers.json")
        self.assertEqual(len(self.results("one")), 4)
        self.assertEqual(self.results("one"), self.results("many"))
        document = json.loads((self.folder / "answers.json").read_text())
        lost = document["inputs"].pop(2)
        (self.folder / "answers.json").write_text(json.dumps(document))
        told = self.blind("--out", "many", "--answers", "answers.json")
        self.assertIn(f"{lost['path']}: left out: answers.json has no result of it", told)
        document["command"] = "recompute"
        (self.folder / "answers.json").write_text(json.dumps(document))
        told = self.blind("--out", "many", "--answers", "answers.json", code=2)
        self.assertEqual(told, "answers.json: error: holds results of recompute (expected: of diagnose)\n")


if __name__ == "__main__":
    PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
