#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Flips one bit after the other in the files of two campaigns, one that is complete and one that was killed under way.

  tests/simulation/bit_flips.py --program build/strainwave --flips 1000 --seed 1

Each flip must be found by `status`, `recompute` or `run --resume`, with the name of the file, or change nothing of what
these three print and store. Half of the flips fall on any file alike, half on any byte alike.
"""
import argparse
import collections
import contextlib
import json
import pathlib
import random
import re
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import time

SMALL = pathlib.Path(__file__).resolve().parent / "small.yaml"


class Campaign:
    def __init__(self, program, folder, schedule):
        self.program, self.folder, self.schedule = program, folder, schedule

    def run(self, *arguments):
        done = subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout, done.stderr

    def start(self, *options):
        return subprocess.Popen([self.program, "run", self.schedule, "--out", self.folder, *options],
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def files(self):
        return sorted(path for path in self.folder.rglob("*") if path.is_file() and path.stat().st_size > 0)

    def looks(self):
        """What is shown of it, as long as nothing is found."""
        yield self.status
        yield lambda: self.run("recompute", self.folder, "--json")

    def status(self):
        """But for the room on the disk, which changes meanwhile."""
        code, out, error = self.run("status", self.folder, "--json")
        return code, re.sub(r'"disk": \{[^}]*\}', "", out), error


class Complete(Campaign):
    def __init__(self, *arguments):
        super().__init__(*arguments)
        assert self.start().wait() == 0


class Killed(Campaign):
    """Killed in the sweep of its last cycle: phases in unfinished/, rows in the write-ahead log."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.resumed = self.folder.with_name("resumed")
        process = self.start("--pace", "200")
        # The rotation, its second phase, is kept when the sweep begins.
        while process.poll() is None and not list(self.folder.glob("unfinished/000002-001-*.h5")):
            time.sleep(0.001)
        process.kill()
        assert process.wait() == -9 and self.files_of("unfinished") and self.files_of("campaign.db-wal")

    def files_of(self, name):
        return [path for path in self.files() if name in str(path.relative_to(self.folder))]

    def looks(self):
        yield from super().looks()
        yield self.resume

    def resume(self):
        """What --resume complains of, and what is then computed from what it has stored."""
        shutil.rmtree(self.resumed, ignore_errors=True)
        shutil.copytree(self.folder, self.resumed)
        code, _, words = self.run("run", self.schedule, "--out", self.resumed, "--resume")
        complaints = [line.replace(str(self.resumed), str(self.folder)) for line in words.splitlines()
                      if "warning: " in line or "error: " in line]
        again, results, error = self.run("recompute", self.resumed, "--json")
        with contextlib.closing(sqlite3.connect(f"file:{self.resumed}/campaign.db?mode=ro", uri=True)) as journal:
            load = journal.execute("SELECT cycle, step, SUM(credited_load_s) FROM phases GROUP BY cycle, step")
            shown = (results, load.fetchall()) if code == again == 0 else None
        return code or again, shown, "\n".join(complaints) + error


def short_schedule(folder):
    schedule = folder / "short.yaml"
    schedule.write_text(SMALL.read_text().replace("cycles: 3", "cycles: 2").replace("duration: 20 min", "duration: 1 min"))
    return schedule


def flip(path, bit):
    with open(path, "r+b") as file:
        file.seek(bit // 8)
        byte = file.read(1)[0] ^ (1 << bit % 8)
        file.seek(bit // 8)
        file.write(bytes([byte]))


def outcome_of(campaign, path, references):
    """'found by N', 'harmless', or what is wrong."""
    # What is read from the log is the journal's.
    name = path.name.removesuffix("-wal").removesuffix("-shm")
    for number, look in enumerate(campaign.looks()):
        seen = look()
        code, _, words = seen
        reference = references[number]
        if seen == reference:
            continue
        if words != reference[2] and name in words:
            return "found by " + ("status", "recompute", "--resume")[number]
        if code not in (0, 1, 2, 3, 130):
            return f"DIED: exit {code}: {words}"
        return f"SILENT: exit {code}: {words or 'other results'}"
    return "harmless"


def kind_of(path, folder):
    relative = path.relative_to(folder)
    return str(relative) if len(relative.parts) == 1 else f"{relative.parts[0]}/*{relative.suffix}"


def options_of(documentation):
    parser = argparse.ArgumentParser(description=documentation, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, type=lambda path: pathlib.Path(path).resolve())
    parser.add_argument("--flips", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args()


def try_flips(options, campaigns, references, outcome_of, faults):
    """Exit code. `outcome_of(campaign, path, reference)` in words; `faults`: how those begin that are not to be."""
    rng = random.Random(options.seed)
    began = time.monotonic()
    counts = collections.Counter()
    bad = []
    for number in range(options.flips):
        campaign = campaigns[number % 2]
        files = campaign.files()
        sizes = [path.stat().st_size for path in files]
        path = rng.choices(files, sizes if number // 2 % 2 else None)[0]
        bit = rng.randrange(8 * path.stat().st_size)
        before = path.read_bytes()
        flip(path, bit)
        outcome = outcome_of(campaign, path, references[number % 2])
        path.write_bytes(before)
        counts[campaign.folder.name, kind_of(path, campaign.folder), outcome.split(":")[0]] += 1
        if outcome.startswith(faults):
            bad.append(f"{campaign.folder.name}/{path.relative_to(campaign.folder)}, bit {bit % 8} of byte {bit // 8}: {outcome}")
    for (folder, kind, outcome), count in sorted(counts.items()):
        print(f"{folder:9} {kind:24} {outcome:20} {count:5}")
    print(f"{options.flips} flips, {len(bad)} not found, {time.monotonic() - began:.0f} s")
    for line in bad:
        print(line)
    return 1 if bad else 0


def main():
    options = options_of(__doc__)
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        schedule = short_schedule(scratch)
        campaigns = [Complete(options.program, scratch / "complete", schedule),
                     Killed(options.program, scratch / "killed", schedule)]
        references = [[look() for look in campaign.looks()] for campaign in campaigns]
        for campaign, seen in zip(campaigns, references):
            assert all(code == 0 for code, *_ in seen), seen
            assert seen == [look() for look in campaign.looks()], "without a flip it is not the same twice"
        return try_flips(options, campaigns, references, outcome_of, ("SILENT", "DIED: "))


if __name__ == "__main__":
    sys.exit(main())
