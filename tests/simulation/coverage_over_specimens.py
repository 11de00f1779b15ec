#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""How often the 95 % intervals of a campaign's results hold the truth, over many specimens and benches.

  tests/simulation/coverage_over_specimens.py --specimens 24

One campaign has one transducer, one blank test and one encoder: their errors are the same in each of its cycles, so
only many of them tell whether a standard error is honest. Each specimen is schedules/quick.yaml on the embedded bench
with another seed.
"""
import argparse
import csv
import pathlib
import sqlite3
import statistics
import subprocess
import tempfile

CHECKOUT = pathlib.Path(__file__).resolve().parents[2]
QUANTITIES = ("k1_Nm_per_rad", "k2_Nm_per_rad", "k3_Nm_per_rad", "e_max_arcmin")


def run(options, folder, seed):
    """Runs one specimen; yields (quantity, value, standard error, truth) of each cycle."""
    bench = folder / f"bench-{seed}.yaml"
    text = options.bench.read_text(encoding="utf-8")
    assert "  seed: 1 " in text or "  seed: 1\n" in text, "the bench file has no seed: 1 to replace"
    bench.write_text(text.replace("  seed: 1", f"  seed: {seed}", 1), encoding="utf-8")
    campaign, truth = folder / f"campaign-{seed}", folder / f"truth-{seed}.csv"
    subprocess.run([options.program, "run", options.schedule, "--bench", bench, "--out", campaign, "--truth", truth],
                   check=True, capture_output=True)
    with open(truth, encoding="utf-8") as file:
        true = {int(row["cycle"]): row for row in csv.DictReader(file)}
    journal = sqlite3.connect(f"file:{campaign / 'campaign.db'}?mode=ro", uri=True)
    for quantity in QUANTITIES:
        for cycle, value, error in journal.execute(
                "SELECT cycle, value, standard_error FROM results WHERE quantity = ? AND cycle > 0 AND repeat = 0",
                (quantity,)):
            yield quantity, value, error, float(true[cycle][quantity])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--specimens", type=int, default=24)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--program", type=pathlib.Path, default=CHECKOUT / "build/strainwave")
    parser.add_argument("--schedule", type=pathlib.Path, default=CHECKOUT / "schedules/quick.yaml")
    parser.add_argument("--bench", type=pathlib.Path, help="bench file with seed: 1; default: the embedded one")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        if options.bench is None:
            # A campaign freezes the bench that it ran on; the embedded one comes from there.
            first = folder / "first"
            subprocess.run([options.program, "run", CHECKOUT / "tests/simulation/small.yaml", "--out", first],
                           check=True, capture_output=True)
            options.bench = first / "bench.yaml"
        rows = [row for seed in range(options.first_seed, options.first_seed + options.specimens)
                for row in run(options, folder, seed)]
    print(f"{'quantity':18} {'values':>6} {'95 % interval holds':>20} {'median |error|':>15} {'worst':>8} {'median se':>10}")
    for quantity in QUANTITIES:
        own = [(value, error, true) for name, value, error, true in rows if name == quantity]
        holds = sum(abs(value - true) <= 1.96 * error for value, error, true in own) / len(own)
        relative = [abs(value / true - 1) for value, _, true in own]
        print(f"{quantity:18} {len(own):6} {100 * holds:19.1f}% {100 * statistics.median(relative):14.3f}% "
              f"{100 * max(relative):7.2f}% {100 * statistics.median(e / abs(v) for v, e, _ in own):9.3f}%")


if __name__ == "__main__":
    main()
