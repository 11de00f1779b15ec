#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Kills campaigns at random moments, resumes them, and compares the end with one that was never killed.

  tests/simulation/kill_and_resume.py --kills 200 --seed 1

A third of the kills is doubled: the resumed program is killed again while it recovers. When a campaign comes to
its end before all kills are spent, another one is begun. Exit code 0: every campaign equals the reference.
"""
import argparse
import hashlib
import json
import math
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import time

import campaign_journal

CHECKOUT = pathlib.Path(__file__).resolve().parents[2]
CREDIT_PER_KILL_S = 1.0
ROUNDING_S = 1e-6
LONGEST_RECOVERY_S = 0.15
# A value this share of its standard error away is the same value: where a cut load run has parked decides which of
# the noise a sweep meets.
INDISTINGUISHABLE = 0.1
# To start a load run again takes some seconds in which the gear cools: once is a twentieth of a kelvin, and a busy
# machine is slow enough for a cycle to be killed a dozen times.
COOLED_K = 0.5
COOLED_K_PER_HOLE = 0.05
# A turn that begins at another angle, because the gear broke away a moment later, hears other teeth first; repeats on
# an undisturbed bench differ by 1.4 % (standard deviation).
VIBRATION_TOLERANCE = 0.10
DECIDING_ERRORS = 4.0
# A threshold crossed under noise, and secants through single crossings of a torque: held against their standard
# errors, all else against the tolerance.
DECIDED_BY_NOISE = {"starting_torque_Nm", "efficiency_percent"} | {f"k{k}_loading_Nm_per_rad" for k in (1, 2, 3)}


class Failure(Exception):
    """The campaign is not what it must be; the text says where."""


def expect(holds, text):
    if not holds:
        raise Failure(text)


class Ledger:
    """What is known about one killed campaign, kept apart from it."""

    def __init__(self, options, folder):
        self.options = options
        self.folder = folder
        self.kills = 0
        self.sealed = {}  # cycle -> (SHA-256 of its file, its results) since it was first seen complete
        self.credited_s = {}  # (cycle, step) -> load time that the program has said to have credited

    def note(self):
        """Reads the campaign as the kill left it, and compares it with what was noted before."""
        journal = campaign_journal.read(self.folder)
        if journal is None:
            expect(not self.sealed, f"{self.folder}: the journal is gone")
            return
        for cycle in sorted(journal.complete):
            file = self.folder / "cycles" / f"{cycle:06d}.h5"
            expect(file.exists(), f"cycle {cycle} is complete, but {file} is missing")
            seal = (hashlib.sha256(file.read_bytes()).hexdigest(),
                    {key: numbers for key, numbers in journal.results.items() if key[0] == cycle})
            expect(self.sealed.setdefault(cycle, seal) == seal, f"cycle {cycle} changed after it was complete")
        expect(set(self.sealed) <= journal.complete, "a complete cycle is complete no more")
        credited_s = dict(journal.credited_s)
        if journal.running_load:
            credited_s[journal.running_load] = self.status()["credited_load_s"]
        for (cycle, step), before_s in self.credited_s.items():
            lost_s = before_s - credited_s.get((cycle, step), 0.0)
            expect(lost_s <= CREDIT_PER_KILL_S, f"cycle {cycle}, step {step} lost {lost_s:.3f} s of {before_s:.3f} s")
        self.credited_s = credited_s

    def status(self):
        answer = subprocess.run([self.options.program, "status", self.folder, "--json"], capture_output=True, text=True)
        expect(answer.returncode == 0, f"status of a killed campaign: {answer.stderr}")
        return json.loads(answer.stdout)


def command(options, folder):
    resume = ["--resume"] if (folder / "campaign.db").exists() else []
    return [str(options.program), "run", str(options.schedule), "--out", str(folder), "--pace", "max", *resume]


def run_for(options, folder, seconds):
    """Runs the campaign and kills it after so many seconds; the exit code when it came to its end before."""
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen(command(options, folder), stdout=output, stderr=subprocess.STDOUT)
        try:
            code = process.wait(timeout=seconds)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            return None
        output.seek(0)
        text = output.read().decode(errors="replace")
        expect(code == 0, f"{' '.join(command(options, folder))} ended with {code}:\n{text[-3000:]}")
        return code


def kill_until_done(options, folder, kills, reference_s, cycles, chance):
    """One campaign with at most so many kills; returns its ledger and how many of them were spent."""
    ledger = Ledger(options, folder)
    spent = 0
    while spent < kills:
        # What is left of the run, spread over the kills that are left: so the campaign ends about when they do.
        left_s = reference_s * (1.0 - len(ledger.sealed) / cycles)
        moment_s = chance.uniform(0.0, max(2.0 * left_s / (kills - spent), options.shortest))
        if run_for(options, folder, moment_s) == 0:
            break
        spent += 1
        ledger.kills += 1
        ledger.note()
        if chance.random() < 1.0 / 3.0:
            if run_for(options, folder, chance.uniform(0.0, LONGEST_RECOVERY_S)) == 0:
                break
            ledger.kills += 1
            ledger.note()
    run_for(options, folder, None)
    ledger.note()
    return ledger, spent


def check_journal(journal):
    """No gap, nothing twice, nothing left open."""
    expect(set(journal.cycles.values()) == {"complete"}, "a cycle is not complete at the end")
    expect(sorted(journal.cycles) == list(range(len(journal.cycles))), "the cycles have a gap")
    for cycle, steps in journal.steps.items():
        expect(len(steps) == len(set(steps)), f"cycle {cycle} has a phase that was completed twice")
    ids = [row[0] for row in journal.phases]
    expect(ids == list(range(1, len(ids) + 1)), "the phases have a gap")
    expect(journal.event_ids == list(range(1, len(journal.event_ids) + 1)), "the events have a gap")
    now_s = 0.0
    interrupted = 0
    for number, cycle, *_, started_s, ended_s, outcome in journal.phases:
        expect(outcome in ("complete", "interrupted"), f"phase {number} of cycle {cycle} ended as '{outcome}'")
        expect(now_s <= started_s + ROUNDING_S and started_s <= ended_s + ROUNDING_S,
               f"phase {number} of cycle {cycle} begins before the one before it has ended")
        now_s = ended_s
        interrupted += outcome == "interrupted"
    expect(journal.holes >= interrupted, f"{interrupted} interrupted phases, but {journal.holes} holes on record")


def compare(options, journal, reference, kills):
    """The killed campaign against the reference; returns the largest relative difference and where it is."""
    expect(journal.steps == reference.steps, "the phases are not those of the reference")
    for (cycle, step), scheduled_s in reference.credited_s.items():
        off_s = journal.credited_s[cycle, step] - scheduled_s
        expect(abs(off_s) <= CREDIT_PER_KILL_S,
               f"cycle {cycle} is credited {off_s:+.3f} s against {scheduled_s:.3f} s, after {kills} kills")
    # What each piece of a load run took by the bench's clock, less the ramps, is what it may be credited with.
    ramps_s = max((duration_s - credited_s for _, duration_s, credited_s in reference.loads), default=0.0)
    for number, duration_s, credited_s in journal.loads:
        expect(-CREDIT_PER_KILL_S <= duration_s - credited_s <= ramps_s + CREDIT_PER_KILL_S,
               f"phase {number} took {duration_s:.3f} s and is credited {credited_s:.3f} s (ramps {ramps_s:.3f} s)")
    # One number of seconds for the whole campaign, too: an error of one sign in each cycle would add up.
    off_s = sum(journal.credited_s.values()) - sum(reference.credited_s.values())
    expect(abs(off_s) <= CREDIT_PER_KILL_S * kills, f"the campaign is credited {off_s:+.3f} s after {kills} kills")
    expect(journal.results.keys() == reference.results.keys(), "the results are not those of the reference")
    worst = (0.0, "no difference")
    for key, (value, standard_error, flag) in journal.results.items():
        true_value, true_error, true_flag = reference.results[key]
        expect(flag == true_flag, f"{key} is flagged '{flag}' (the reference: '{true_flag}')")
        if value is None or true_value is None:
            expect(value == true_value, f"{key} is {value} (the reference: {true_value})")
            continue
        # A mean close to zero is compared by what it could be told from zero.
        scale = max(abs(true_value), abs(true_error or 0.0))
        difference = abs(value - true_value) / scale if scale > 0.0 else float(value != true_value)
        if key[2] in DECIDED_BY_NOISE:
            expect(abs(value - true_value) <= DECIDING_ERRORS * math.hypot(standard_error, true_error),
                   f"{key} is {value} ± {standard_error} (the reference: {true_value} ± {true_error})")
            continue
        if abs(value - true_value) <= INDISTINGUISHABLE * (true_error or 0.0):
            continue
        if key[2].endswith("_degC"):
            expect(abs(value - true_value) <= max(COOLED_K, COOLED_K_PER_HOLE * journal.holes),
                   f"{key} is {value} (the reference: {true_value})")
            continue
        if key[2].endswith("_equivalent_s"):  # of the rows on record; those of the last ten seconds go with a kill
            expect(0.0 <= value <= true_value * (1.0 + options.tolerance + options.served_again),
                   f"{key} is {value} (the reference: {true_value})")
            continue
        if key[2].startswith("vibration_rms_"):
            expect(difference <= VIBRATION_TOLERANCE,
                   f"{key} is {value} (the reference: {true_value})")
            continue
        worst = max(worst, (difference, f"cycle {key[0]}, {key[2]}: {value} (the reference: {true_value})"))
    expect(not math.isnan(worst[0]) and worst[0] <= options.tolerance,
           f"relative difference {worst[0]:.3g} above {options.tolerance:g}, {worst[1]}")
    return (*worst, off_s)


def with_cycles(schedule, cycles, folder):
    """The schedule with another number of cycles, as a file of its own."""
    text, replaced = re.subn(r"^cycles: \d+", f"cycles: {cycles}", schedule.read_text(encoding="utf-8"), flags=re.M)
    assert replaced == 1, f"{schedule}: no 'cycles:' to replace"
    changed = folder / "schedule.yaml"
    changed.write_text(text, encoding="utf-8")
    return changed


def run_all(options, folder):
    if options.cycles:
        options.schedule = with_cycles(options.schedule, options.cycles, folder)
    chance = random.Random(options.seed)
    start = time.monotonic()
    run_for(options, folder / "reference", None)
    reference_s = time.monotonic() - start
    reference = campaign_journal.read(folder / "reference")
    check_journal(reference)
    print(f"reference: {len(reference.cycles)} cycles in {reference_s:.1f} s", flush=True)
    spent = doubled = campaigns = 0
    while spent < options.kills:
        campaigns += 1
        killed = folder / f"killed-{campaigns}"
        ledger, used = kill_until_done(options, killed, options.kills - spent, reference_s, len(reference.cycles),
                                       chance)
        journal = campaign_journal.read(killed)
        check_journal(journal)
        difference, where, off_s = compare(options, journal, reference, ledger.kills)
        spent += used
        doubled += ledger.kills - used
        print(f"{killed.name}: {ledger.kills} kills, {journal.holes} holes, credited load off by {off_s:+.4f} s, "
              f"largest relative difference {difference:.3g} ({where})", flush=True)
    print(f"{spent} kills, {doubled} of them doubled, in {campaigns} campaigns: all equal the reference")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=20, help="default: %(default)s")
    parser.add_argument("--seed", type=int, default=1, help="of the moments; default: %(default)s")
    parser.add_argument("--schedule", type=pathlib.Path, default=CHECKOUT / "schedules" / "quick.yaml")
    parser.add_argument("--cycles", type=int, help="of the schedule, in place of its own; many spread the kills out")
    parser.add_argument("--program", type=pathlib.Path, default=CHECKOUT / "build" / "strainwave")
    parser.add_argument("--tolerance", type=float, default=1e-3, help="relative, of results that differ by more than a tenth of their error; default: %(default)s")
    parser.add_argument("--shortest", type=float, default=0.1, metavar="S",
                        help="least upper end of the random moments, in seconds; default: %(default)s")
    parser.set_defaults(served_again=0.0)  # share of the load; a kill takes nothing that was credited
    parser.add_argument("--folder", type=pathlib.Path, help="keep the campaigns here")
    options = parser.parse_args()
    try:
        if options.folder:
            options.folder.mkdir(parents=True)
            run_all(options, options.folder)
        else:
            with tempfile.TemporaryDirectory() as folder:
                run_all(options, pathlib.Path(folder))
    except Failure as failure:
        print(f"kill_and_resume.py: error: seed {options.seed}: {failure}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
