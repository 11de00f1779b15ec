#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Holds what a simulated campaign has measured against the truth that only the simulation knows.

  build/strainwave run schedules/paper.yaml --out campaigns/paper --truth campaigns/truth.csv
  tests/simulation/compare_with_truth.py campaigns/paper campaigns/truth.csv

The truth is the plant's own parameters at the end of each cycle's measurements; no part of the measurement sees it.
"""
import argparse
import csv
import pathlib
import sqlite3
import statistics

QUANTITIES = ("k1_Nm_per_rad", "k2_Nm_per_rad", "k3_Nm_per_rad", "e_max_arcmin", "e_avg_arcmin", "hysteresis_arcmin")
# Other ways to read the same loops, held against the same truth.
METHODS = {f"k{k}_{method}_Nm_per_rad": f"k{k}_Nm_per_rad" for method in ("loading", "backbone") for k in (1, 2, 3)}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("campaign", type=pathlib.Path)
    parser.add_argument("truth", type=pathlib.Path)
    options = parser.parse_args()
    with open(options.truth, encoding="utf-8") as file:
        truth = {int(row["cycle"]): row for row in csv.DictReader(file)}
    journal = sqlite3.connect(f"file:{options.campaign / 'campaign.db'}?mode=ro", uri=True)
    print(f"{'quantity':26} {'cycles':>6} {'median error':>13} {'median |error|':>15} {'worst':>8} "
          f"{'95 % interval holds':>20} {'median se':>10}")
    for quantity in QUANTITIES + tuple(METHODS):
        rows = [(value, error, float(truth[cycle][METHODS.get(quantity, quantity)]))
                for cycle, value, error in journal.execute(
                    "SELECT cycle, value, standard_error FROM results WHERE quantity = ? AND cycle > 0 AND repeat = 0",
                    (quantity,)) if cycle in truth]
        relative = [value / true - 1 for value, _, true in rows]
        holds = sum(abs(value - true) <= 1.96 * error for value, error, true in rows) / len(rows)
        print(f"{quantity:26} {len(rows):6} {100 * statistics.median(relative):+12.3f}% "
              f"{100 * statistics.median(map(abs, relative)):14.3f}% {100 * max(map(abs, relative)):7.2f}% "
              f"{100 * holds:19.1f}% {100 * statistics.median(abs(e / v) for v, e, _ in rows):9.3f}%")
    flagged = journal.execute("SELECT COUNT(DISTINCT cycle) FROM results WHERE flag <> '' AND cycle > 0").fetchone()[0]
    again = journal.execute("SELECT COUNT(DISTINCT cycle) FROM phases WHERE repeat > 0").fetchone()[0]
    print(f"cycles with a flag: {flagged}; measured again: {again}")


if __name__ == "__main__":
    main()
