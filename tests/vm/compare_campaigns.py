#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Holds the results of a campaign over real protocols against those of the embedded bench, cycle by cycle.

  tests/vm/compare_campaigns.py D/campaign EMBEDDED

One line a quantity and cycle: both values with their standard errors, and how far apart they are in standard errors of
the difference. Of what both campaigns share (one specimen, one transducer) nothing shows in the difference, so it may be
smaller than the standard errors say, not larger. Exit code 1 where a mean difference is beyond --most of them.
"""
import argparse
import math
import pathlib
import sqlite3
import statistics
import sys

QUANTITIES = ("k1_Nm_per_rad", "k2_Nm_per_rad", "k3_Nm_per_rad", "e_max_arcmin", "e_avg_arcmin", "hysteresis_arcmin")


def results(folder):
    journal = sqlite3.connect(f"file:{folder / 'campaign.db'}?mode=ro", uri=True)
    # Before the first cycle the measurements are repeated, to learn how well they repeat. These are as good as a
    # cycle's, but their standard errors do not hold that yet: the scatter of the campaign stands in.
    rows = journal.execute("SELECT cycle, repeat, quantity, value, standard_error, flag FROM results "
                           "WHERE (cycle > 0 AND repeat = 0) OR (cycle = 0 AND repeat > 0)")
    rows = [row for row in rows if row[2] in QUANTITIES]
    scatter = {quantity: statistics.pstdev([row[3] for row in rows if row[2] == quantity]) for quantity in QUANTITIES
               if any(row[2] == quantity for row in rows)}
    return {(str(cycle) if cycle else f"0, repeat {repeat}", quantity):
            (value, error if cycle else math.hypot(error, scatter[quantity]), flag)
            for cycle, repeat, quantity, value, error, flag in rows}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("measured", type=pathlib.Path)
    parser.add_argument("embedded", type=pathlib.Path)
    parser.add_argument("--most", type=float, default=3.0, help="standard errors that a mean difference may have")
    parser.add_argument("--scatter", type=float, default=0.0, help="of a campaign too short to know how well it repeats: "
                        "percent of each value that come on top of its standard error")
    options = parser.parse_args()
    measured, embedded = results(options.measured), results(options.embedded)
    cycles = sorted({cycle for cycle, _ in measured} & {cycle for cycle, _ in embedded}, key=lambda name: (len(name) < 3, len(name), name))
    if not cycles:
        raise SystemExit("the campaigns have no cycle in common (expected one complete cycle in both)")
    print("| quantity | cycle | measured | embedded | difference | in standard errors |")
    print("| --- | --- | --- | --- | --- | --- |")
    far = []
    for quantity in QUANTITIES:
        differences, variances = [], []
        for cycle in cycles:
            if (cycle, quantity) not in measured or (cycle, quantity) not in embedded:
                far.append(f"{quantity}, cycle {cycle}: missing")
                continue
            (a, a_error, flag), (b, b_error, _) = measured[cycle, quantity], embedded[cycle, quantity]
            error = math.hypot(a_error, b_error, 0.01 * options.scatter * a, 0.01 * options.scatter * b)
            differences.append(a - b)
            variances.append(error * error)
            print(f"| {quantity} | {cycle} | {a:.6g} ± {a_error:.2g} | {b:.6g} ± {b_error:.2g} | {a - b:+.3g} | "
                  f"{(a - b) / error:+.2f} |{' ' + flag if flag else ''}")
        if not differences:
            continue
        mean = sum(differences) / len(differences)
        # As wrong as one cycle, where the cycles share what makes them wrong.
        error = math.sqrt(sum(variances) / len(variances))
        scatter = math.sqrt(sum((d - mean) ** 2 for d in differences) / max(1, len(differences) - 1))
        print(f"| {quantity} | mean | | | {mean:+.3g}, scatter {scatter:.2g} | {mean / error:+.2f} |")
        if abs(mean) > options.most * error:
            far.append(f"{quantity}: {mean:+.3g} is {mean / error:+.1f} standard errors")
    for line in far:
        print(line)
    return 1 if far else 0


if __name__ == "__main__":
    sys.exit(main())
