#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave faults` on two bearing rigs of others: a table for docs/faults.md.

usage: faults_on_rigs.py [PROGRAM] [--keep DIR] [--seeds N]

HIT: https://github.com/hitwzc/Bearing-datasets, "Self-built dataset": inner and outer race damaged over 2, 5 and 8
degrees, 600, 900, 1200 rpm. CWRU: bearing data of Case Western Reserve University, four files. They are looked for in
STRAINWAVE_DATA, else in ../shared/data beside the checkout. Records are cut by turns of the shaft: 4096 samples are
less than one turn of the first rig at 600 rpm.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "data"))
import mat5  # noqa: E402

DATA = pathlib.Path(os.environ.get("STRAINWAVE_DATA", ROOT.parent / "shared" / "data"))
TURNS = 4.2  # of a record; the orders need four
RECORDS = 12  # of a file


def write(path, channels, rate_hz, speed_rpm):
    head = f"# kind: vibration\n# sample_rate_hz: {rate_hz}\n# input_speed_rpm: {speed_rpm}\n{','.join(channels)}"
    numpy.savetxt(path, numpy.column_stack(list(channels.values())), fmt="%.7g", delimiter=",", header=head, comments="")


def cut(folder, rows, name, channels, rate_hz, speed_rpm, labels):
    """Records of so many turns, evenly over the file, and their rows of labels.csv."""
    length = int(TURNS * rate_hz * 60 / speed_rpm)
    samples = len(next(iter(channels.values())))
    for k in range(min(RECORDS, samples // length)):
        begin = k * (samples // RECORDS) if samples // length >= RECORDS else k * length
        file = f"{name}_{k}.csv"
        write(folder / file, {key: values[begin:begin + length] for key, values in channels.items()}, rate_hz, speed_rpm)
        rows.append(f"{file},{labels}")


def hit(folder):
    rows = ["file,unit,class,severity_deg,rpm"]
    for path in sorted((DATA / "hit_bearing_rig").glob("*.mat")):
        state, rpm = path.stem.split("_")
        values = max(mat5.read(path).values(), key=lambda array: array.size).ravel()
        name = {"N": "normal", "I": "inner_race", "O": "outer_race"}[state[0]]
        severity = "0" if name == "normal" else state[2:]
        cut(folder, rows, path.stem, {"accel_x_g": values}, 51200, int(rpm), f"bearing_{state},{name},{severity},{rpm}")
    (folder / "labels.csv").write_text("\n".join(rows) + "\n")
    return ["--split", "rpm", "--split", "severity_deg"]


def cwru(folder):
    rows = ["file,unit,class,load_hp"]
    for path in sorted((DATA / "cwru_bearing").glob("*.mat")):
        arrays = mat5.read(path)
        channels = {f"accel_{key[-7:-5].lower()}_g": array.ravel() for key, array in arrays.items()
                    if key.endswith(("_DE_time", "_FE_time"))}
        shortest = min(map(len, channels.values()))
        channels = {key: values[:shortest] for key, values in channels.items()}
        state, load = path.stem.rsplit("_", 1)
        name = {"n": "normal", "I": "inner_race", "O": "outer_race"}[state[0]]
        speed = [array for key, array in arrays.items() if key.endswith("RPM")]
        rpm = int(speed[0].ravel()[0]) if speed else {"0": 1797, "3": 1721}[load]
        cut(folder, rows, path.stem, channels, 12000, rpm, f"{path.stem},{name},{load}")
    (folder / "labels.csv").write_text("\n".join(rows) + "\n")
    return ["--split", "load_hp"]


def share(values):
    known = [value for value in values if value is not None]
    if not known:
        return "not possible"
    spread = f" ({100 * min(known):.1f} to {100 * max(known):.1f})" if len(known) > 1 else ""
    return f"{100 * sum(known) / len(known):.1f}{spread}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?", default=str(ROOT / "build" / "strainwave"))
    parser.add_argument("--keep", type=pathlib.Path, help="folder for records and models")
    parser.add_argument("--seeds", type=int, default=3)
    arguments = parser.parse_args()
    if not (DATA / "hit_bearing_rig").exists():
        print(f"skipped, because there is no {DATA / 'hit_bearing_rig'} (STRAINWAVE_DATA, or ../shared/data)")
        return 77
    with tempfile.TemporaryDirectory() as scratch:
        root = arguments.keep or pathlib.Path(scratch)
        for convert in (hit, cwru):
            folder = root / convert.__name__
            folder.mkdir(parents=True, exist_ok=True)
            splits = convert(folder)
            reports = []
            for seed in range(1, arguments.seeds + 1):
                command = [arguments.program, "faults", "train", str(folder), "--out", str(root / f"{convert.__name__}_model"),
                           "--json", "--seed", str(seed), *splits]
                done = subprocess.run(command, capture_output=True, text=True, check=False)
                if done.returncode != 0:
                    print(done.stderr)
                    return 1
                reports.append(json.loads(done.stdout))
            print(f"\n{convert.__name__}: {reports[0]['records']} records, {arguments.seeds} seeds; taken: "
                  f"{', '.join(sorted({report['features'] for report in reports}))}")
            for split in reports[0]["accuracy"]:
                cells = [f"{name} {share([report['compared'][name]['accuracy'][split] for report in reports])}"
                         for name in reports[0]["compared"]]
                print(f"  {split:<16} {'; '.join(cells)}")
            for limit in reports[0]["limits"]:
                print(f"  limit: {limit}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
