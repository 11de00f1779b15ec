#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The figures of docs/fingerprints.md: accuracy and area under the curve of each way to tell faulty arms, on each split,
over several simulated data sets: mean, least and greatest.

usage: fingerprint_figures.py PROGRAM [--seeds N] [--units N]      a seed takes one to three minutes"""
import argparse
import json
import pathlib
import statistics
import subprocess
import tempfile

SPLITS = ("random", "file_left_out", "unit_left_out", "origin_left_out")
TABLES = ("raw", "fingerprint", "fingerprint_per_file")


def call(*arguments):
    return json.loads(subprocess.run([*map(str, arguments), "--json"], capture_output=True, text=True, check=True).stdout)


def told(name, scores_of):
    """@param scores_of  by split, of each data set."""
    for split, scores in scores_of.items():
        line = f"{name:<42} {split:<16}"
        for key in ("accuracy", "auc"):
            values = [score[key] for score in scores if score[key] is not None]
            if values:
                line += f"  {key} {statistics.mean(values):.3f} [{min(values):.3f}, {max(values):.3f}]"
        print(line, flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--seeds", type=int, default=3, help="data sets; default: %(default)s")
    parser.add_argument("--units", type=int, help="of each origin and class; default: those of the study, 22 in all")
    options = parser.parse_args()
    reports = []
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(1, options.seeds + 1):
            arms = pathlib.Path(folder) / f"arms{seed}"
            call(options.program, "simulate", "--study", "arm", "--out", arms, "--seed", seed,
                 *(("--units", options.units) if options.units else ()))
            reports.append(call(options.program, "fingerprint", "train", arms, "--out", pathlib.Path(folder) / f"model{seed}"))
            print(f"seed {seed}: {reports[-1]['files']} files of {reports[-1]['units']} units, explanations of the files' own "
                  f"networks {reports[-1]['explanations_s']:.2f} s", flush=True)
    for table in TABLES:
        for kind in reports[0][table]:
            told(f"{table} {kind}", {split: [report[table][kind][split] for report in reports] for split in SPLITS})
    for key in ("excess_friction", "shuffled_labels"):
        told(key, {split: [report[key][split] for report in reports] for split in SPLITS})


if __name__ == "__main__":
    main()
