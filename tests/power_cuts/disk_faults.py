#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The k-th write, sync, open, rename ... of a campaign fails with EIO, ENOSPC, EDQUOT or EROFS, once or from there on. The
program ends with a sentence that names a file, never by a signal; what is there is read; with the disk mended, `run
--resume` brings the campaign to the end of one on a disk that never failed.

  tests/power_cuts/disk_faults.py --program build/strainwave --disk build/tests/power_cut_disk --seed 1
  ... --every 17           every 17th k of each kind of fault, from one that the seed chooses
  ... --at 300             this k alone
  ... --quick-clock FILE   what a run does every ten seconds is done in each; words are not looked at

Exit code 77: skipped, with the reason."""
import argparse
import collections
import errno
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile

import cut_disk
from ledger import Lost, expect

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "simulation"))
import campaign_journal  # noqa: E402
import kill_and_resume  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
TOLERANCE = 1e-3  # as of power cuts
LONGEST_S = 60
MACHINE_FAILED = 3
FAULTS = [(name, lasting) for name in ("EIO", "ENOSPC", "EDQUOT", "EROFS") for lasting in (False, True)]
WORDS = "|".join(os.strerror(getattr(errno, name)) for name in ("EIO", "ENOSPC", "EDQUOT", "EROFS")) + "|disk is full"
WORDS += "|unable to open database file"  # SQLite tries it in another way, and tells why that failed
STOPPED = "stopped: torque is off, brakes are on"


class Sweep:
    def __init__(self, options, folder):
        self.options = options
        self.folder = folder
        self.environment = {**os.environ, "PATH": "/nonexistent", "USER": "nobody"}
        if options.quick_clock:
            self.environment |= {"LD_PRELOAD": str(options.quick_clock), "STRAINWAVE_QUICK_CLOCK": "1000"}
        self.number = 0
        self.met = collections.Counter()  # operations that failed, by what came of it
        self.operations = {}  # errno's name -> how many there are
        for name in ("EIO", "ENOSPC"):
            with self.new_disk().mounted(fail_at=0, errno=getattr(errno, name)) as (place, report):
                code, text = self.run(place / "campaign")
                expect(code == 0, f"undisturbed it ended with {code}: {text}")
                self.reference = campaign_journal.read(place / "campaign")
            self.operations[name] = report["met"]

    def new_disk(self):
        self.number += 1
        return cut_disk.CutDisk(self.options.disk, self.folder / str(self.number))

    def call(self, *arguments):
        done = subprocess.run([self.options.program, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              env=self.environment, timeout=LONGEST_S, check=False)
        return done.returncode, done.stdout.decode(errors="replace")

    def run(self, campaign):
        resume = ["--resume"] if (campaign / "campaign.db").exists() else []
        return self.call("run", self.options.schedule, "--out", campaign, "--pace", "max", *resume)

    def one(self, k, name, lasting):
        """Whether anything failed."""
        disk = self.new_disk()
        with disk.mounted(fail_at=k, errno=getattr(errno, name), lasting=int(lasting)) as (place, report):
            campaign = place / "campaign"
            code, text = self.run(campaign)
            disk.mend()
            begun = (campaign / "campaign.db").exists()
            if code != 0:
                self.check_words(code, text, campaign, begun)
            if begun:
                self.check_readable(campaign)
            more, words = (0, text) if code == 0 else self.run(campaign)
            expect(more == 0, f"on the mended disk it ended with {more}:\n{words}after\n{text}")
            self.check_end(campaign)
        if report["failed"]:
            self.met[f"{report['failed']}: {'ended' if code else 'went on'}"] += 1
            if self.options.verbose:
                print(f"k = {k}, {name}, {'lasting' if lasting else 'once'}: {report['failed']}: {code}: {text}", flush=True)
        return bool(report["failed"])

    def check_words(self, code, text, campaign, begun):
        expect(code == MACHINE_FAILED, f"ended with {code}:\n{text}")
        last = text.strip().splitlines()[-1] if text.strip() else ""
        if self.options.quick_clock:  # by which nobody waits for words to be read
            return
        expect(str(campaign.parent) in last and re.search(WORDS, last), f"no file is named, or not why:\n{text}")
        journal = campaign_journal.read(campaign) if begun else None
        if journal and journal.phases and len(journal.complete) < len(self.reference.complete):
            expect(STOPPED in text, f"nothing is said of torque and brakes:\n{text}")

    def check_readable(self, campaign):
        code, text = self.call("status", campaign)
        expect(code == 0, f"status ended with {code}:\n{text}")
        code, text = self.call("verify", campaign)
        expect(code == 0, f"verify ended with {code}:\n{text}")

    def check_end(self, campaign):
        journal = campaign_journal.read(campaign)
        kill_and_resume.check_journal(journal)
        options = argparse.Namespace(tolerance=TOLERANCE, served_again=1.0)
        kill_and_resume.compare(options, journal, self.reference, 1)

    def all(self):
        """Yields what is wrong."""
        chance = random.Random(self.options.seed)
        for name, lasting in FAULTS:
            first = chance.randrange(self.options.every) + 1
            number_of = self.operations["EIO" if name == "EIO" else "ENOSPC"]
            for k in [self.options.at] if self.options.at else range(first, number_of + 1, self.options.every):
                try:
                    self.one(k, name, lasting)
                except (Lost, kill_and_resume.Failure, AssertionError, subprocess.TimeoutExpired) as failure:
                    yield f"k = {k}, {name}, {'lasting' if lasting else 'once'}: {failure}"


def run_all(options, folder):
    sweep = Sweep(options, folder)
    print(f"{sweep.operations['EIO']} operations, {sweep.operations['ENOSPC']} of them change something", flush=True)
    failures = 0
    for failure in sweep.all():
        print(f"error: {failure}", file=sys.stderr, flush=True)
        failures += 1
    tried = sum(sweep.met.values())
    expect(failures == 0, f"{failures} of {tried + failures} were not survived")
    print(f"{tried} faults: each told, or of a file that a campaign does without; all campaigns equal the reference")
    for what, count in sorted(sweep.met.items()):
        print(f"{count:5} {what}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, required=True)
    parser.add_argument("--disk", type=pathlib.Path, required=True, help="the file system, power_cut_disk")
    parser.add_argument("--quick-clock", type=pathlib.Path, help="the library quick_clock")
    parser.add_argument("--schedule", type=pathlib.Path, default=HERE / "short.yaml")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--at", type=int, metavar="K")
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    for name in ("program", "disk", "schedule"):
        setattr(options, name, getattr(options, name).resolve())
    cut_disk.begin_in_own_mounts()
    if why := cut_disk.is_possible(options.disk):
        print(f"skipped, because {why}")
        return cut_disk.SKIPPED
    try:
        with tempfile.TemporaryDirectory() as folder:
            run_all(options, pathlib.Path(folder))
    except (Lost, kill_and_resume.Failure) as failure:
        print(f"disk_faults.py: error: seed {options.seed}: {failure}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
