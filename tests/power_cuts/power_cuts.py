#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Cuts the power with the k-th write, sync, rename ... of a campaign, for every k until the campaign is complete before;
goes on with what is left, and compares with what the program had kept before.

  tests/power_cuts/power_cuts.py --program build/strainwave --disk build/tests/power_cut_disk --seed 1
  ... --every 17           every 17th k, from one that the seed chooses
  ... --first 300          none below
  ... --doubled            the power goes again while the program goes on
  ... --fail-syncs         in place of the power, the N-th sync fails
  ... --forget END         syncs of what has a name with this end do nothing: 0 where that is found

Exit code 0: everything that had been kept is there, what is left is read and gone on with, and the end equals that of a
campaign that was never cut. 77: skipped, with the reason."""
import argparse
import collections
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile

import cut_disk
import ledger

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "simulation"))
import campaign_journal  # noqa: E402
import kill_and_resume  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
TOLERANCE = 1e-3  # relative, of results that differ by more than a tenth of their error, as of kills
MACHINE_FAILED = 3
# A campaign goes on without these: what others look at while it runs; the log's copy into the journal's file, which is
# tried again; names in its folder, which SQLite syncs after the program has done so.
DISPENSABLE = {"readings", "envelope", "sources", "campaign.db", "campaign"}
# What is said then: of a plain file, and of the journal.
SYNC_FAILED = "cannot sync .*: Input/output error|campaign.db.*: error: disk I/O error"
SYNCS_OF_CLOSING = 3
RECOMPUTED_EVERY = 5
MOST_CUTS = 20  # of one campaign


class Ratchet:
    def __init__(self, options, folder):
        self.options = options
        self.folder = folder
        self.chance = random.Random(options.seed)
        # No pictures: they are of what is kept.
        self.environment = {"PATH": "/nonexistent", "USER": "nobody"}
        if options.quick_clock:
            self.environment |= {"LD_PRELOAD": str(options.quick_clock), "STRAINWAVE_QUICK_CLOCK": str(options.clock)}
        self.met = collections.Counter()  # operations with which the power went
        self.cuts = self.doubled = 0
        self.worst = (0.0, "no difference")
        disk = self.new_disk()
        # With syncs as they should be.
        done = disk.run(self.command, environment=self.environment, seed=self.chance.getrandbits(32))
        ledger.expect(done.code == 0, f"the campaign on the file system of the test ended with {done.code}:\n{done.text}")
        self.reference = campaign_journal.read(disk.side("disk"))
        ledger.expect(self.reference, "nothing is left of a campaign that had come to its end")
        kill_and_resume.check_journal(self.reference)
        self.operations, self.syncs = done.operations, done.syncs
        print(f"reference: {len(self.reference.cycles)} cycles, {done.operations} operations, {done.syncs} of them syncs",
              flush=True)

    def new_disk(self):
        folder = self.folder / "disk"
        shutil.rmtree(folder, ignore_errors=True)
        return cut_disk.CutDisk(self.options.disk, folder)

    def command(self, campaign):
        resume = ["--resume"] if (campaign / "campaign.db").exists() else []
        return [self.options.program, "run", self.options.schedule, "--out", campaign, "--pace", "max", *resume]

    def run(self, disk, **options):
        return disk.run(self.command, environment=self.environment, seed=self.chance.getrandbits(32),
                        forget=self.options.forget, **options)

    def go_on(self, disk, book):
        """Until the campaign is complete; how many more cuts it took."""
        for cuts in range(MOST_CUTS):
            again = self.options.doubled and cuts < 2
            done = self.run(disk, cut_at=self.chance.randint(1, 60) if again else 0)
            book.note(disk)
            book.compare(disk, recomputes=not done.cut)
            if not done.cut:
                ledger.expect(done.code == 0, f"run --resume ended with {done.code}:\n{done.text}")
                return cuts
            self.met[done.last_operation.split()[0]] += 1
        raise ledger.Lost("the campaign does not come to its end")

    def check_end(self, disk, interruptions):
        journal = campaign_journal.read(disk.side("disk"))
        kill_and_resume.check_journal(journal)
        # Load whose credit was not on the disk yet, but its rows were, is run again, and both count as wear.
        options = argparse.Namespace(tolerance=TOLERANCE, served_again=float(interruptions))
        *worst, _ = kill_and_resume.compare(options, journal, self.reference, interruptions)
        self.worst = max(self.worst, tuple(worst))

    def cut_at(self, number):
        """Whether the campaign was cut, or came to its end before."""
        disk, book = self.new_disk(), ledger.Ledger(self.options.program)
        done = self.run(disk, cut_at=number)
        book.note(disk)
        # The ledger has the digest of each cycle already: recomputed is a part of them.
        book.compare(disk, recomputes=number % RECOMPUTED_EVERY == 0)
        if done.cut:
            self.cuts += 1
            self.met[done.last_operation.split()[0]] += 1
            more = self.go_on(disk, book)
            self.doubled += more > 0
            self.check_end(disk, 1 + more)
        else:
            ledger.expect(done.code == 0, f"run ended with {done.code}:\n{done.text}")
        return done.cut

    def fail_sync(self, number):
        """Whether a sync failed. Doubled: the machine stays up, the next program goes on, and then the power goes."""
        disk, book = self.new_disk(), ledger.Ledger(self.options.program)
        commands = [self.command, self.command] if self.options.doubled else [self.command]
        done = disk.run(*commands, environment=self.environment, seed=self.chance.getrandbits(32), fail_sync=number,
                        cut_after=self.chance.randint(1, 120) if self.options.doubled else 0)
        book.note(disk)
        book.compare(disk)
        if not done.failed_sync:
            return False
        self.cuts += 1
        self.met[done.failed_sync] += 1
        if not self.options.doubled:
            expect_words(done, number)
        self.doubled += done.cut
        self.check_end(disk, 1 + self.go_on(disk, book))
        return True

    def turn(self):
        """Every k until there is none more; yields what is wrong."""
        step = self.fail_sync if self.options.fail_syncs else self.cut_at
        number = self.options.first + self.chance.randrange(self.options.every)
        more = True
        while more:
            try:
                more = step(number)
            except (ledger.Lost, kill_and_resume.Failure, AssertionError) as failure:
                yield f"k = {number}: {failure}"
            number += self.options.every
            if self.cuts % 100 == 0:
                print(f"{self.cuts} survived", flush=True)


def expect_words(done, number):
    """A sync that fails ends the program, in words; or the file is one that a campaign does without."""
    if done.code == 0:
        name = done.failed_sync.removeprefix(".").removesuffix(".partial")
        # The log is synced once more before it is copied at the end; each commit in it had been.
        at_the_end = name == "campaign.db-wal" and done.syncs - number < SYNCS_OF_CLOSING
        ledger.expect(name in DISPENSABLE or at_the_end, f"nobody minds that {done.failed_sync} was not synced:\n{done.text}")
        return
    ledger.expect(done.code == MACHINE_FAILED and re.search(SYNC_FAILED, done.text),
                  f"ended with {done.code} when {done.failed_sync} was not synced:\n{done.text}")


def run_all(options, folder):
    ratchet = Ratchet(options, folder)
    failures = 0
    for failure in ratchet.turn():
        if options.forget is not None:
            print(f"that syncs of {options.forget or 'everything'} do nothing is found: {failure.splitlines()[0]}")
            return
        print(f"error: {failure}", file=sys.stderr, flush=True)
        failures += 1
    ledger.expect(options.forget is None, f"nothing shows that syncs of {options.forget or 'everything'} do nothing")
    ledger.expect(failures == 0, f"{failures} of {ratchet.cuts} were not survived")
    what = "failed syncs" if options.fail_syncs else "cuts"
    print(f"{ratchet.cuts} {what}, {ratchet.doubled} of them doubled: nothing that was kept is lost, all campaigns equal the "
          "reference")
    print("with " + ", ".join(f"{count} {name}" for name, count in sorted(ratchet.met.items())))
    print(f"largest relative difference of a result: {ratchet.worst[0]:.3g} ({ratchet.worst[1]})")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, required=True)
    parser.add_argument("--disk", type=pathlib.Path, required=True, help="the file system, power_cut_disk")
    parser.add_argument("--quick-clock", type=pathlib.Path, help="the library quick_clock")
    parser.add_argument("--clock", type=int, default=1000, help="how many times faster it goes; default: %(default)s")
    parser.add_argument("--schedule", type=pathlib.Path, default=HERE / "short.yaml")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--first", type=int, default=1, metavar="K")
    parser.add_argument("--doubled", action="store_true")
    parser.add_argument("--fail-syncs", action="store_true")
    parser.add_argument("--forget", metavar="END")
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
    except (ledger.Lost, kill_and_resume.Failure) as failure:
        print(f"power_cuts.py: error: seed {options.seed}: {failure}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
