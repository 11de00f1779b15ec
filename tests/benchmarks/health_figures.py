#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The figures of docs/health.md: errors of the splits over several simulated data sets, the same sampled at 50 Hz,
another motion, and false alarms on healthy cycles of a wafer robot that others measured.

usage: health_figures.py PROGRAM [--seeds N] [--units N] [--only splits,slow,motion,alarms]

False alarms need ../shared/data/wafer_robot_healthy beside the checkout, or the folder in STRAINWAVE_DATA: 562 cycles
of an accelerometer's three axes. Two of them stand in the places of current and speed. Since all are healthy, a fault
is put into a third of them (a tone of 30 % of the signal), to have something to learn; false alarms are counted on
healthy cycles that were not trained on."""
import argparse
import csv
import json
import math
import os
import pathlib
import statistics
import subprocess
import tempfile
import zipfile

HERE = pathlib.Path(__file__).resolve().parents[2]


def call(*arguments):
    return json.loads(subprocess.run([*map(str, arguments), "--json"], capture_output=True, text=True, check=True).stdout)


def told(name, reports):
    """A line a component and split: mean over the seeds, least and greatest."""
    for component in reports[0]["components"]:
        for split in ("random", "unit_left_out", "condition_left_out"):
            values = [report["rmse"][component][split] for report in reports]
            if None in values:
                continue
            print(f"{name:<22} {component:<4} {split:<20} {statistics.mean(values):.4f}  [{min(values):.4f}, {max(values):.4f}]",
                  flush=True)


def simulated(program, folder, study, seed, units):
    call(program, "simulate", "--study", study, "--out", folder, "--seed", seed, "--units", units)
    return folder


def every_twentieth(source, target):
    """1 kHz to 50 Hz without a filter: what lies above 25 Hz folds."""
    (target / "records").mkdir(parents=True)
    for name in ("labels.csv", "failed_conditions.csv"):
        (target / name).write_bytes((source / name).read_bytes())
    for path in (source / "records").iterdir():
        lines = path.read_text().splitlines()
        head = [line.replace("sample_rate_hz: 1000", "sample_rate_hz: 50") for line in lines if line.startswith("#")]
        rows = [line for line in lines if not line.startswith("#")]
        (target / "records" / path.name).write_text("\n".join([*head, rows[0], *rows[1::20]]) + "\n")
    return target


def across(program, model, folder):
    """Errors of a model on a data set of another motion."""
    with (folder / "labels.csv").open() as file:
        known = {row["file"]: row for row in csv.DictReader(file)}
    errors, outside = {"hd": [], "tb": []}, []
    for record in call(program, "health", "assess", model, folder):
        row = known[str(pathlib.Path(record["file"]).relative_to(folder))]
        outside.append(record["outside_training"])
        for name, values in errors.items():
            values.append(record["health"][name]["value"] - float(row["health_" + name]))
    rmse = {name: math.sqrt(statistics.mean(value * value for value in values)) for name, values in errors.items()}
    return rmse, statistics.mean(outside)


def alarms(program, work):
    data = pathlib.Path(os.environ.get("STRAINWAVE_DATA", HERE / "../shared/data")) / "wafer_robot_healthy/raw_data.zip"
    if not data.exists():
        print(f"false alarms: skipped, because there is no {data}")
        return
    archive = zipfile.ZipFile(data)
    names = sorted((name for name in archive.namelist() if name.endswith(".csv")), key=lambda name: int(name[:-4]))
    (work / "train").mkdir(parents=True)
    (work / "unseen").mkdir()
    labels = ["file,unit,health_axis"]
    for place, name in enumerate(names):
        rows = [[float(cell) for cell in line.split(",")[:2]] for line in archive.read(name).decode().splitlines()[1:]
                if line.count(",") == 2 and all(line.split(","))]
        # Blocks of ten cycles that follow each other are a unit: healthy, with a fault, unseen, in turn.
        role = place // 10 % 3
        if role == 1:
            size = 0.3 * statistics.pstdev(row[0] for row in rows)
            rows = [[row[0] + size * math.sin(0.9 * i), row[1]] for i, row in enumerate(rows)]
        folder = work / ("unseen" if role == 2 else "train")
        text = "\n".join(["# kind: motor", "# sample_rate_hz: 100", "current_A,velocity_rad_per_s",
                          *(f"{row[0] / 10:.4f},{row[1] / 10:.4f}" for row in rows)])
        (folder / name).write_text(text + "\n")
        if role < 2:
            labels.append(f"{name},block{place // 10},{role}")
    (work / "train" / "labels.csv").write_text("\n".join(labels) + "\n")
    report = call(program, "health", "train", work / "train", "--out", work / "model")
    print(f"healthy wafer robot: rmse {report['rmse']['axis']}")
    records = call(program, "health", "assess", work / "model", work / "unseen")
    worn = sum(record["health"]["axis"]["value"] > 0.5 for record in records)
    sure = sum(record["health"]["axis"]["low"] > 0.5 for record in records)
    outside = sum(record["outside_training"] for record in records)
    print(f"false alarms on {len(records)} unseen healthy cycles: {worn} with a health above 0.5, {sure} of them with the whole "
          f"interval; {outside} outside the training")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--units", type=int, default=4)
    parser.add_argument("--only", default="splits,slow,motion,alarms")
    options = parser.parse_args()
    parts = options.only.split(",")
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        plain, slow = [], []
        for seed in range(1, options.seeds + 1):
            if not {"splits", "slow", "motion"} & set(parts):
                break
            data = simulated(options.program, work / f"data{seed}", "wafer_robot", seed, options.units)
            model = work / f"model{seed}"
            plain.append(call(options.program, "health", "train", data, "--out", model))
            told(f"1 kHz, seed {seed}", plain[-1:])
            print("  ", plain[-1]["selected"], plain[-1]["hidden_nodes"], plain[-1]["gpr"], flush=True)
            if "slow" in parts:
                slow.append(call(options.program, "health", "train", every_twentieth(data, work / f"slow{seed}"), "--out",
                                 work / f"slow_model{seed}"))
            if "motion" in parts:
                other = simulated(options.program, work / f"other{seed}", "wafer_robot_slow", seed + 100, 1)
                print(f"another motion, seed {seed}: rmse {across(options.program, model, other)}", flush=True)
        if plain:
            told("1 kHz", plain)
        if slow:
            told("50 Hz", slow)
        if "alarms" in parts:
            alarms(options.program, work / "alarms")


if __name__ == "__main__":
    main()
