#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave fleet` on Slurm: a step, a node and the controller are killed, and the bytes are those of one process.

usage: fleet_slurm_test.py PROGRAM     exit code 77: skipped, there is no Slurm"""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import slurm_cluster

PROGRAM = ""
RECORDS, SHARDS = 120, 4


class FleetOnSlurm(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = pathlib.Path(scratch.name)
        cls.folder.chmod(0o711)
        cls.cluster = slurm_cluster.Cluster(cls.folder / "slurm")
        cls.addClassCleanup(cls.cluster.stop)
        cls.until(lambda: cls.cluster.ask("sinfo", "-h", "-o", "%T %D") == "idle 2\n")
        for seed in range(6):
            assert cls.run_in("simulate", "hysteresis", "--seed", seed, "--out", f"{seed}.csv")[0] == 0
        cls.records = [f"{number % 6}-{number}.csv" for number in range(RECORDS)]
        for name in cls.records:
            shutil.copy(cls.folder / f"{name[0]}.csv", cls.folder / name)

    @classmethod
    def run_in(cls, *arguments):
        done = subprocess.run([PROGRAM, *map(str, arguments)], cwd=cls.folder, env=cls.cluster.environment, capture_output=True,
                              text=True, check=False)
        return done.returncode, done.stdout, done.stderr

    @classmethod
    def until(cls, holds):
        """Waits for it; ctest's limit ends what never comes."""
        while not holds():
            time.sleep(0.1)

    def fleet(self, *arguments):
        code, said, told = self.run_in("fleet", *arguments)
        self.assertEqual(code, 0, (arguments, said, told))
        return said

    def status(self):
        return json.loads(self.fleet("status", "plan", "--json"))

    def kept(self, shard):
        inputs = json.loads((self.folder / "plan/plan.json").read_text())["inputs"]
        return sum((self.folder / "plan/results" / f"{entry['key']}.json").exists() for entry in inputs if entry["shard"] == shard)

    def running_on(self, node):
        return [shard for shard, (state, where, _) in self.cluster.tasks(self.job).items() if state == "RUNNING" and where == node]

    def begin_what_waits(self):
        """What a site's administrator would do: a task that is requeued waits for two minutes; where the controller died before it
        had written down what it had begun, it begins that again, drains the node that has it already, and holds the task."""
        for shard, (state, _, reason) in self.cluster.tasks(self.job).items():
            if state == "PENDING" and "held" in reason.lower():
                self.cluster.ask("scontrol", "release", f"{self.job}_{shard}")
            elif state == "PENDING" and reason == "BeginTime":
                self.cluster.ask("scontrol", "update", f"jobid={self.job}_{shard}", "starttime=now")
        for node in slurm_cluster.NODES:
            if "drain" in self.cluster.ask("sinfo", "-h", "-n", node, "-o", "%T"):
                self.cluster.ask("scontrol", "update", f"nodename={node}", "state=resume")

    def whole_or_begun(self):
        self.begin_what_waits()
        return self.status()["done"] == RECORDS

    def test_whatever_is_killed_the_bytes_are_those_of_one_process(self):
        said = self.fleet("submit", "diagnose", *self.records, "--out", "plan", "--shards", SHARDS)
        self.job = said.split("job ")[1].split(",")[0]
        self.assertIn(f"{SHARDS} of {SHARDS} shards", said)
        self.until(lambda: all(self.kept(shard) > 0 for shard in range(SHARDS)))
        # Tasks that run are not submitted a second time.
        self.assertIn("nothing to submit", self.fleet("submit", "--out", "plan"))
        status = self.status()
        self.assertEqual((status["done"] + status["running"], status["missing"]), (RECORDS, 0))

        with self.subTest("a step"):
            on_n2 = self.running_on("n2")
            processes = self.cluster.batches(shard=on_n2[0])
            steps = self.cluster.steps_of(processes)
            self.assertEqual(len(steps), 1)
            for process in steps | set(processes):
                os.kill(process, signal.SIGKILL)
            self.assertLess(self.kept(on_n2[0]), RECORDS // SHARDS)
            # The other one goes on without its step, and Slurm, which does not know, runs it once more.
            for process in self.cluster.steps_of(self.cluster.batches(shard=on_n2[1])):
                os.kill(process, signal.SIGKILL)

        with self.subTest("a node"):
            on_n1 = self.running_on("n1")
            self.assertEqual(len(on_n1), 2)
            self.cluster.kill_node("n1")
            for shard in on_n1:
                self.assertLess(self.kept(shard), RECORDS // SHARDS)

        with self.subTest("the controller"):
            self.cluster.kill("slurmctld")
            status = self.status()
            self.assertNotEqual(status["slurm"]["trouble"], "")
            self.assertLess(status["done"], RECORDS)
            code, _, told = self.run_in("fleet", "collect", "plan", "--out", "plan.json")
            self.assertEqual(code, 1, told)
            self.assertIn("have no result", told)
        self.cluster.start_controller()
        self.until(lambda: set(self.cluster.tasks(self.job)) == set(range(SHARDS)))
        # The node comes back when the controller has seen that it was away.
        self.until(lambda: all(self.cluster.tasks(self.job).get(shard, ["RUNNING"])[0] != "RUNNING" for shard in on_n1))
        self.cluster.start_node("n1")

        self.until(self.whole_or_begun)
        self.until(lambda: not self.cluster.batches())
        self.fleet("collect", "plan", "--out", "plan.json")
        self.fleet("submit", "diagnose", *self.records, "--out", "one", "--shards", 1, "--local", "--jobs", 1)
        self.fleet("collect", "one", "--out", "one.json")
        self.assertEqual((self.folder / "plan.json").read_bytes(), (self.folder / "one.json").read_bytes())


if __name__ == "__main__":
    PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    if slurm_cluster.missing():
        print("skipped, because slurm-wlm is not installed")
        sys.exit(77)
    unittest.main()
