#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Campaigns of short cycles on drives of each kind in turn (CANopen on vcan0, Modbus TCP, Modbus RTU), with faults of
devices at random moments, resumed after each stop, and a ledger kept from outside.

  tests/vm/run.sh --write D tests/vm/soak.py build D                     2 h of the machine's time (VM_SECONDS=20000)
  tests/vm/run.sh --write D tests/vm/soak.py build D --minutes 6         to try it
  tests/vm/soak.py build D --kinds tcp,rtu --minutes 4                   here, in real time: Modbus needs no CAN

After every fault that the bench can see, torque is off and both brakes are on within the stated time, as the device
side has it; load that is credited was served there; no cycle is lost, done twice or changed; results are those of a
campaign without faults. The same seed draws the same faults. D/soak.txt is the ledger, D/KIND_campaigns what was compared. Exit code 1 where one of these
does not hold.
"""
import argparse
import hashlib
import math
import pathlib
import random
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "simulation"))
import campaign_journal
import soak_bench
import vm_bench

KINDS = soak_bench.KINDS
MANY_CYCLES = 1000
REFERENCE_CYCLES = 2
SHORTEST_PAUSE_S, LONGEST_PAUSE_S = 3.0, 40.0
# What may have been credited until a fault was noticed.
CREDIT_A_FAULT_S = 0.35
LONGEST_CYCLE_S = 900.0
LONGEST_END_S = 60.0  # what is on record ten seconds after a stop included
PATIENCE_S = 15.0
MANY_ERRORS = 5.0
# Which teeth are heard, how warm the gear is and what it starts from differ from cycle to cycle, by more than what a
# value's own error says.
# A load run that was interrupted has more ramps, which weigh less than the time that they take. Of the first loading
# from zero the first stiffness depends on where the gear was left: 25 % here, where the loop's own does not change.
SCATTER = {"k1_loading": 0.3, "vibration": 0.25, "temperature": 0.2, "starting_torque": 0.5, "equivalent": 0.15}
SCATTER_OF_OTHERS = 0.02


class Failure(Exception):
    """What the ledger and the campaign do not agree in."""


def expect(holds, what):
    if not holds:
        raise Failure(what)


def until(condition, seconds):
    give_up = time.monotonic() + seconds
    while not (holds := condition()) and time.monotonic() < give_up:
        time.sleep(0.1)
    return holds


class Devices(vm_bench.Devices):
    def served_s(self):
        before = len(self.lines.said)
        self.process.stdin.write("load served\n")
        self.process.stdin.flush()
        said = self.lines.wait_for("under load", 30, before)
        expect(said is not None, "strainwave-devices does not say what load it served")
        return float(said[1].split()[1])


class Ledger:
    """What is known of one campaign, kept apart from it."""

    def __init__(self, folder, devices):
        self.folder, self.devices = folder, devices
        self.sealed = {}
        self.faults = 0
        self.served_before_s = devices.served_s()

    def credited_s(self, journal):
        return sum(journal.credited_s.values())

    def served_s(self):
        return self.devices.served_s() - self.served_before_s

    def note(self):
        """Reads the campaign after a stop, and holds it against what was known before."""
        journal = campaign_journal.read(self.folder)
        for cycle in sorted(journal.complete - {0}):  # the preparation has no file
            file = self.folder / "cycles" / f"{cycle:06d}.h5"
            expect(file.exists(), f"cycle {cycle} is complete, and {file} is missing")
            seal = (hashlib.sha256(file.read_bytes()).hexdigest(),
                    {key: numbers for key, numbers in journal.results.items() if key[0] == cycle})
            expect(self.sealed.setdefault(cycle, seal) == seal, f"cycle {cycle} changed after it was complete")
        expect(self.sealed.keys() <= journal.complete, "a complete cycle is complete no more")
        expect(sorted(journal.cycles) == list(range(min(journal.cycles, default=0), min(journal.cycles, default=0) + len(journal.cycles))),
               f"the cycles have a gap: {sorted(journal.cycles)}")
        for cycle, steps in journal.steps.items():
            expect(len(steps) == len(set(steps)), f"cycle {cycle} has a phase that was completed twice: {steps}")
        credited_s, served_s = self.credited_s(journal), self.served_s()
        expect(credited_s <= served_s + CREDIT_A_FAULT_S * (self.faults + 1),
               f"{credited_s:.2f} s are credited and {served_s:.2f} s were served, after {self.faults} faults")
        return journal, credited_s, served_s


def means(journal):
    """quantity -> (mean over the cycles, standard error of one, scatter of the cycles)."""
    values = {}
    for (cycle, repeat, quantity), (value, error, _) in journal.results.items():
        if cycle in journal.complete and repeat == 0 and value is not None:
            values.setdefault(quantity, []).append((value, error or 0.0))
    return {quantity: (statistics.mean(v for v, _ in all_of), max(e for _, e in all_of), statistics.pstdev([v for v, _ in all_of]))
            for quantity, all_of in values.items()}


def compare(journal, reference):
    """Each result of each cycle against the mean without faults; the number of them, and the worst in its tolerance."""
    worst, count = (0.0, ""), 0
    truth = means(reference)
    for (cycle, repeat, quantity), (value, error, flag) in sorted(journal.results.items()):
        if cycle not in journal.complete or repeat != 0 or value is None or flag:
            continue  # what is flagged is told to be no good
        expect(quantity in truth, f"{quantity} of cycle {cycle} is not among the results without faults")
        mean, mean_error, scatter = truth[quantity]
        share = next((s for word, s in SCATTER.items() if word in quantity or quantity.endswith("_degC")), SCATTER_OF_OTHERS)
        allowed = MANY_ERRORS * math.hypot(error or 0.0, mean_error, scatter) + share * abs(mean)
        count += 1
        short = mean - value
        # What was interrupted is measured again: of what comes in there is more then, never less.
        off = max(0.0, short) if quantity.startswith("samples_received") else abs(short)
        off = off / allowed if allowed > 0.0 else float(off > 0.0)
        worst = max(worst, (off, f"{quantity} of cycle {cycle}: {value:.6g} (without faults {mean:.6g}, allowed ± {allowed:.2g})"))
        expect(off <= 1.0, f"{worst[1]}, flagged '{flag}'")
    return count, worst


class Soak:
    def __init__(self, options, kind, say):
        self.options, self.kind, self.say = options, kind, say
        self.campaign = None
        self.chance = random.Random(f"{options.seed} {kind}")
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.bench = self.folder / "bench.yaml"
        text = soak_bench.bench_text(kind)
        self.bench.write_text(text, encoding="utf-8")
        self.log = open(options.out / f"{kind}_run.txt", "w", encoding="utf-8")
        self.devices = Devices(options.build, self.bench, open(options.out / f"{kind}_devices.txt", "w", encoding="utf-8"))
        self.bench.write_text(soak_bench.with_lines(text, [line for _, line in self.devices.lines.said]), encoding="utf-8")

    def end(self):
        """Whatever is still running, the campaign first: it leaves the drives by its own way out."""
        for process in (self.campaign and self.campaign.process, self.devices.process):
            if process and process.poll() is None:
                process.terminate()
                process.wait(30)

    def run(self, name, cycles, resume=False):
        schedule = self.folder / f"{name}.yaml"
        schedule.write_text(soak_bench.schedule_text(self.kind, cycles), encoding="utf-8")
        self.campaign = vm_bench.Campaign(self.options.build, schedule, self.bench, self.folder / name, self.devices, None, self.log, resume)
        return self.campaign

    def reference(self):
        ledger = Ledger(self.folder / "reference", self.devices)
        code = self.run("reference", REFERENCE_CYCLES).wait(LONGEST_CYCLE_S * REFERENCE_CYCLES)
        expect(code == 0, f"the campaign without faults ended with {code}")
        journal, _, _ = ledger.note()
        return journal

    def put_in(self, fault, campaign, ledger):
        """The fault, until it is mended. Whether it was seen, and after how long the shafts were safe (nothing where that
        says nothing: a drive that is off, or is asked for no more than it gives, is found when it is used)."""
        lines_before = len(campaign.lines.said)
        ledger.faults += 1
        in_use = self.devices.safe_since() is None

        def says(*words):
            return any(word in line for _, line in campaign.lines.said[lines_before:] for word in words)

        def is_seen():
            return campaign.process.poll() is not None or says("alarm: ", "suspended: ")

        begin = time.monotonic()
        self.devices.do(fault.command)
        until(is_seen, fault.stated_s + PATIENCE_S)
        until(lambda: not is_seen() or self.devices.safe_since() is not None, PATIENCE_S)
        safe_since = self.devices.safe_since()
        if fault.mend:
            self.devices.do(fault.mend)
        if not until(is_seen, 1.0):
            return False, None
        # What suspends a phase is an alarm while the references are checked.
        if not fault.suspends or says("alarm: "):
            expect(campaign.wait(LONGEST_END_S) is not None, f"after '{fault.command}' the campaign goes on")
        expect(safe_since is not None, f"after '{fault.command}' the shafts are not safe")
        if not in_use or fault.waits:
            return True, None
        after_s = safe_since - begin
        expect(after_s <= fault.stated_s, f"after '{fault.command}' the shafts were safe after {after_s:.3f} s (stated: {fault.stated_s:.3f} s)")
        return True, after_s

    def soak(self, seconds):
        reference = self.reference()
        self.say(f"{self.kind}: {len(reference.complete)} cycles without faults, {len(reference.results)} results")
        end = time.monotonic() + seconds
        faults = soak_bench.faults_of(self.kind)
        ledger = Ledger(self.folder / "soaked", self.devices)
        campaign = self.run("soaked", MANY_CYCLES)
        expect(campaign.lines.wait_for("load_run", 60), "the campaign does not begin")
        stops = unseen = 0
        while time.monotonic() < end:
            pause_s = self.chance.uniform(SHORTEST_PAUSE_S, LONGEST_PAUSE_S)
            fault = self.chance.choice(faults)
            code = campaign.wait(pause_s)
            expect(code is None, f"the campaign ended with {code} by itself")
            seen, after_s = self.put_in(fault, campaign, ledger)
            unseen += not seen
            said = f"{self.kind}: {time.monotonic() - vm_bench.STARTED:8.1f} s  {fault.command}: "
            if after_s is None:
                said += "stopped when it was used" if seen else "not seen where it came"
            else:
                said += f"safe after {1e3 * max(0.0, after_s):.0f} ms of {1e3 * fault.stated_s:.0f}"
            if campaign.process.poll() is not None:
                stops += 1
                _, credited_s, served_s = ledger.note()
                said += f"; credited {credited_s:.2f} s of {served_s:.2f} s served; resumed"
                campaign = self.run("soaked", MANY_CYCLES, resume=True)
            self.say(said)
        stop = [self.options.build / "strainwave", "stop", self.folder / "soaked", "finish-cycle"]
        # Nobody runs the campaign yet where it was resumed just now: that is no error of 'stop'.
        taken = lambda: "asked process" in subprocess.run(stop, check=False, stdout=subprocess.PIPE, text=True).stdout
        expect(until(lambda: campaign.process.poll() is not None or taken(), PATIENCE_S), "the campaign takes no stop")
        code = campaign.wait(LONGEST_CYCLE_S)
        expect(code in (0, 130), f"the campaign ended with {code}")
        journal, credited_s, served_s = ledger.note()
        count, worst = compare(journal, reference)
        self.say(f"{self.kind}: {ledger.faults} faults, {stops} stops, {unseen} not seen; {len(journal.complete)} cycles complete; "
                 f"credited {credited_s:.2f} s of {served_s:.2f} s served; {count} results, the worst at {worst[0]:.2f} of what is "
                 f"allowed: {worst[1]}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=pathlib.Path, help="folder with strainwave and strainwave-devices")
    parser.add_argument("out", type=pathlib.Path, help="gets the ledger and what the programs said")
    parser.add_argument("--minutes", type=float, default=120.0, help="of this machine's time, shared by the kinds; default: %(default)g")
    parser.add_argument("--seed", type=int, default=1, help="of moments and faults; default: %(default)s")
    parser.add_argument("--kinds", default=",".join(KINDS), help="default: %(default)s")
    options = parser.parse_args()
    options.build = options.build.resolve()
    options.out.mkdir(exist_ok=True, parents=True)
    kinds = options.kinds.split(",")
    with open(options.out / "soak.txt", "w", encoding="utf-8") as file:
        def say(line):
            print(line, flush=True)
            print(line, file=file, flush=True)
        code = 0
        for kind in kinds:
            soak = Soak(options, kind, say)
            try:
                soak.soak(60.0 * options.minutes / len(kinds))
            except Failure as failure:
                say(f"soak.py: error: {kind}, seed {options.seed}: {failure}")
                code = 1
            finally:
                soak.end()
                shutil.copytree(soak.folder, options.out / f"{kind}_campaigns", dirs_exist_ok=True)
    return code


if __name__ == "__main__":
    sys.exit(main())
