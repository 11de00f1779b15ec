#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave fleet` as a user calls it, without Slurm: the same bytes however it was cut, killed and gone on with.

usage: fleet_command_test.py PROGRAM SCHEDULE"""
import csv
import hashlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM, SCHEDULE = "", ""
NO_SLURM = {**os.environ, "PATH": "/nowhere"}


class Fleet(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = pathlib.Path(scratch.name)
        cls.loops = []
        for seed in range(1, 7):
            cls.loops.append(f"loop{seed}.csv")
            assert cls.run_in("simulate", "hysteresis", "--seed", seed, "--out", cls.loops[-1])[0] == 0
        assert cls.run_in("simulate", "vibration", "--seed", 1, "--out", "vibration.csv")[0] == 0

    @classmethod
    def run_in(cls, *arguments, program=None, env=None):
        done = subprocess.run([program or PROGRAM, *map(str, arguments)], cwd=cls.folder, capture_output=True, text=True,
                              check=False, env=env)
        return done.returncode, done.stdout, done.stderr

    def fleet(self, *arguments, code=0, **others):
        got, said, told = self.run_in("fleet", *arguments, **others)
        self.assertEqual(got, code, (arguments, said, told))
        return said, told

    def collected(self, plan, code=0):
        self.fleet("collect", plan, "--out", f"{plan}.json", code=code)
        return (self.folder / f"{plan}.json").read_bytes()

    def test_however_it_is_cut_the_bytes_are_those_of_one_process(self):
        for command, records, options in (("recompute", self.loops, ["--method", "backbone"]),
                                          ("features", ["vibration.csv"] * 3, ["--levels", "3"]),
                                          ("diagnose", self.loops[:3], ["--seed", "4"])):
            with self.subTest(command=command):
                behind = ["--", *options]
                self.fleet("submit", command, *records, "--out", f"one_{command}", "--local", "--jobs", 1, "--shards", 1, *behind)
                self.fleet("submit", command, *records, "--out", f"many_{command}", "--local", "--jobs", 2, *behind)
                one = self.collected(f"one_{command}")
                self.assertEqual(one, self.collected(f"many_{command}"))
                reports = [entry["report"] for entry in json.loads(one)["inputs"]]
                if command == "diagnose":  # which fits several records together
                    direct = [json.loads(self.run_in(command, record, "--json", *options)[1]) for record in records]
                else:
                    direct = json.loads(self.run_in(command, *records, "--json", *options)[1])
                self.assertEqual(reports, direct)

    def test_the_sums_are_those_of_the_table(self):
        self.fleet("submit", "recompute", *self.loops, "--out", "sums", "--local")
        self.fleet("collect", "sums", "--out", "sums.json", "--csv", "sums.csv")
        with (self.folder / "sums.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["path"] for row in rows], self.loops)
        k1 = [float(row["k1_Nm_per_rad"]) for row in rows]
        over = json.loads((self.folder / "sums.json").read_text())["over_records"]["k1_Nm_per_rad"]
        self.assertEqual(over["count"], len(k1))
        self.assertAlmostEqual(over["mean"], sum(k1) / len(k1), delta=1e-9 * k1[0])

    def test_a_shard_that_is_killed_is_gone_on_with(self):
        records = self.loops * 4
        self.fleet("submit", "diagnose", *records, "--out", "whole", "--local")
        self.fleet("submit", "diagnose", *records, "--out", "killed", "--shards", 1, code=3, env=NO_SLURM)
        results = self.folder / "killed/results"
        shard = subprocess.Popen([PROGRAM, "fleet", "shard", "killed", "0"], cwd=self.folder, stdout=subprocess.DEVNULL)
        while not any(results.glob("*.json")):
            self.assertIsNone(shard.poll(), "the shard ended before it kept a result")
            time.sleep(0.001)
        shard.kill()
        shard.wait()
        there = json.loads(self.fleet("status", "killed", "--json")[0])
        self.assertEqual(there["done"] + there["missing"], len(records))
        self.assertGreater(there["missing"], 0)
        told = self.fleet("collect", "killed", "--out", "killed.json", code=1)[1]
        self.assertTrue(told.startswith(f"{self.folder.resolve()}/killed: error: {there['missing']} of 24 records have no result "
                                        f"(expected all; strainwave fleet submit --out {self.folder.resolve()}/killed computes "
                                        "what is missing)\n  loop"), told)
        self.assertFalse((self.folder / "killed.json").exists())
        said = self.fleet("shard", "killed", 0)[0]
        self.assertRegex(said, r"^shard 0: \d+ records computed, \d+ were there, 0 failed\n$")
        self.assertEqual(self.collected("killed"), self.collected("whole"))

    def test_a_changed_record_is_refused_by_its_hash(self):
        shutil.copy(self.folder / "loop1.csv", self.folder / "own.csv")
        self.fleet("submit", "recompute", "own.csv", "loop2.csv", "--out", "changed", code=3, env=NO_SLURM)
        before = (self.folder / "own.csv").read_bytes()
        (self.folder / "own.csv").write_bytes(before + b"\n")
        told = self.fleet("submit", "--out", "changed", "--local", code=2)[1]
        after = hashlib.sha256(before + b"\n").hexdigest()
        self.assertEqual(told, f"own.csv: error: has changed since the plan was made: its SHA-256 is {after} ({len(before) + 1} "
                               f"bytes) (expected SHA-256 {hashlib.sha256(before).hexdigest()}, {len(before)} bytes; a new plan "
                               "for what it is now)\n")
        self.assertEqual(json.loads(self.fleet("status", "changed", "--json")[0])["done"], 1)
        (self.folder / "own.csv").write_bytes(before)
        self.fleet("submit", "--out", "changed", "--local")
        self.collected("changed")

    def test_another_program_is_refused(self):
        self.fleet("submit", "recompute", "loop1.csv", "--out", "version", code=3, env=NO_SLURM)
        other = self.folder / "other"
        shutil.copy(PROGRAM, other)
        with other.open("ab") as file:
            file.write(b"rebuilt")
        sums = [hashlib.sha256(pathlib.Path(program).read_bytes()).hexdigest() for program in (other, PROGRAM)]
        version = self.run_in("--version")[1].strip()
        message = (f"{self.folder.resolve()}/version/plan.json: error: the plan was made for another program than this {version}, "
                   f"SHA-256 {sums[0]} (expected {version}, SHA-256 {sums[1]}; or a new plan)\n")
        self.assertEqual(self.fleet("shard", "version", 0, code=2, program=other)[1], message)
        self.assertEqual(self.fleet("submit", "--out", "version", "--local", code=2, program=other)[1], message)

    def test_without_slurm_it_says_what_to_do(self):
        said, told = self.fleet("submit", "recompute", "loop1.csv", "--out", "none", code=3, env=NO_SLURM)
        self.assertEqual((said, told), ("", "error: there is no sbatch on this machine (expected Slurm's client, Debian's "
                                            "slurm-client; or --local, which computes the same here)\n"))

    def test_a_refused_record_holds_up_no_other(self):
        self.fleet("submit", "recompute", "vibration.csv", "loop1.csv", "--out", "refused", "--local")
        first = json.loads(self.collected("refused", code=1))["inputs"][0]
        self.assertEqual((first["exit_code"], first["report"]), (2, None))
        self.assertEqual(first["error"], "vibration.csv: error: kind 'vibration' has nothing to recompute (expected "
                                         "transmission_error or hysteresis)")

    def test_values_of_options_are_looked_at_before_anything_is_written(self):
        told = self.fleet("submit", "recompute", "loop1.csv", "--out", "bad", "--local", "--", "--method", "best", code=2)[1]
        self.assertEqual(told, "error: strainwave recompute: --method: best not in {model,loading,backbone}\n")
        told = self.fleet("submit", "recompute", "gone.csv", "--out", "bad", "--local", code=2)[1]
        self.assertEqual(told, "gone.csv: error: there is no such file (expected a record)\n")
        self.assertFalse((self.folder / "bad").exists())
        self.fleet("status", "bad", "--foo", code=2)
        self.fleet("status", "bad", "--", "x", code=2)

    def test_the_cycles_of_a_campaign_rest_on_its_journal(self):
        code, _, told = self.run_in("run", SCHEDULE, "--out", "campaign")
        self.assertEqual(code, 0, told)
        self.fleet("submit", "recompute", "campaign", "--out", "cycles", "--local")
        inputs = json.loads(self.collected("cycles"))["inputs"]
        self.assertEqual(len(inputs), 12)
        direct = json.loads(self.run_in("recompute", "campaign/cycles/000003.h5", "--json")[1])
        self.assertEqual(inputs[2]["path"], "campaign/cycles/000003.h5")
        self.assertEqual(inputs[2]["report"], direct)
        code, _, told = self.run_in("note", "campaign", "grease", "--by", "A. Meier")
        self.assertEqual(code, 0, told)
        for result in (self.folder / "cycles/results").iterdir():
            result.unlink()
        told = self.fleet("submit", "--out", "cycles", "--local", code=2)[1]
        self.assertIn("campaign/campaign.db", told)
        self.assertIn("the plan was made", told)


if __name__ == "__main__":
    PROGRAM, SCHEDULE = str(pathlib.Path(sys.argv.pop(1)).resolve()), str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
