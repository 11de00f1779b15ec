#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The figures of docs/faults.md on simulated joints: each seed is a data set of its own, with its own mountings.

usage: faults_figures.py [PROGRAM] [--seeds N] [--units N] [--keep DIR]
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SINGLES = ("--where", "faults=0,1")
OPEN = ("--where", "anti_alias_filter=0")
FILTERED = ("--where", "anti_alias_filter=1")
SPLITS = ("--split", "speed_percent", "--split", "load_kg")
RUNS = {
    "ours": (*SINGLES, *OPEN, *SPLITS, "--compare"),
    "line of the study": (*SINGLES, *OPEN, *SPLITS, "--line", "study", "--epochs", "5000"),
    "ours, with a filter": (*SINGLES, *FILTERED),
    "ours, with and without": (*SINGLES, "--split", "anti_alias_filter"),
    "pairs as classes": OPEN,
    "several at once": ("--multi-label", *OPEN),
}


def run(program, *arguments):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(done.stderr)
    return done.stdout


def percent(values):
    known = [100 * value for value in values if value is not None]
    return f"{sum(known) / len(known):5.1f} ({min(known):.1f} to {max(known):.1f})" if known else "not possible"


def table(reports, key):
    for name in reports[0][key]:
        cells = ", ".join(f"{split} {percent([report[key][name].get(split) for report in reports])}"
                          for split in reports[0][key][name])
        print(f"    {name:<8} {cells}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?", default=str(ROOT / "build" / "strainwave"))
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--units", type=int, default=4)
    parser.add_argument("--keep", type=pathlib.Path, help="folder for data sets and models")
    arguments = parser.parse_args()
    reports = {name: [] for name in RUNS}
    with tempfile.TemporaryDirectory() as scratch:
        root = arguments.keep or pathlib.Path(scratch)
        for seed in range(1, arguments.seeds + 1):
            folder = root / f"joint_{seed}"
            if not folder.exists():
                run(arguments.program, "simulate", "--study", "joint_bearing", "--out", folder, "--seed", seed, "--units",
                    arguments.units)
            for name, options in RUNS.items():
                start = time.monotonic()
                out = root / f"model_{seed}_{name.replace(' ', '_').replace(',', '')}"
                reports[name].append(json.loads(run(arguments.program, "faults", "train", folder, "--out", out, "--json",
                                                    "--seed", seed, *options)))
                print(f"seed {seed}, {name}: {time.monotonic() - start:.1f} s", file=sys.stderr)
    for name, runs in reports.items():
        print(f"\n{name}: {runs[0]['records']} records, {runs[0]['units']} units")
        for split in runs[0]["accuracy"]:
            undecided = percent([report["splits"][split].get("undecided") for report in runs])
            print(f"  {split:<18} {percent([report['accuracy'][split] for report in runs])}; undecided {undecided}")
        for key in ("accuracy_by_levels", "accuracy_by_wavelet"):
            if key in runs[0]:
                print(f"  {key}")
                table(runs, key)
    return 0


if __name__ == "__main__":
    sys.exit(main())
