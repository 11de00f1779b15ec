#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Opens a campaign folder with ordinary tools alone (sqlite3, h5py) and checks what docs/contract.md promises.

  tests/repository/peers/open_campaign.py DIR
"""
import argparse
import hashlib
import pathlib
import sqlite3
import sys

import h5py
import numpy

MOST_SHOWN = 20
TABLES = ("cycles", "phases", "results", "events", "calibrations", "operator_notes")
# Endings of column names that carry a unit (docs/contract.md#units-and-signs).
UNITS = ("_deg", "_rad", "_arcmin", "_rpm", "_rad_per_s", "_Nm", "_N", "_m", "_m_per_s", "_m_per_s2", "_s", "_degC",
         "_A", "_K", "_Nm_per_rad")


class Findings(list):
    def expect(self, holds, text):
        if not holds:
            self.append(text)


def check_journal(folder, findings):
    """Checks campaign.db and returns the numbers of the complete cycles."""
    path = folder / "campaign.db"
    journal = sqlite3.connect(f"file:{path}?mode=ro", uri=True)
    with journal:
        findings.expect(journal.execute("PRAGMA integrity_check").fetchone() == ("ok",), f"{path}: damaged")
        findings.expect(journal.execute("PRAGMA journal_mode").fetchone() == ("wal",), f"{path}: not in WAL mode")
        tables = {name for (name,) in journal.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
        missing = [table for table in TABLES if table not in tables]
        findings.expect(not missing, f"{path}: tables {missing} are missing")
        if missing:
            return []
        cycles = [cycle for (cycle,) in journal.execute(
            "SELECT cycle FROM cycles WHERE outcome = 'complete' ORDER BY cycle")]
        without = [cycle for cycle in cycles if not journal.execute(
            "SELECT 1 FROM results WHERE cycle = ? LIMIT 1", (cycle,)).fetchone()]
        findings.expect(not without, f"{path}: complete cycles {without} have no results")
        sums = set()
        for table in tables:
            columns = [column for (_, column, *_) in journal.execute(f"PRAGMA table_info({table})")]
            for column in columns:
                sums.update(value for (value,) in journal.execute(f"SELECT {column} FROM {table}")
                            if isinstance(value, str) and len(value) == 64)
    journal.close()
    for name in ("schedule.yaml", "bench.yaml"):
        frozen = folder / name
        findings.expect(frozen.is_file(), f"{frozen}: missing")
        if frozen.is_file():
            findings.expect(hashlib.sha256(frozen.read_bytes()).hexdigest() in sums,
                            f"{frozen}: its SHA-256 is not in the journal")
    return cycles


def check_dataset(path, dataset, findings):
    where = f"{path}: {dataset.name}"
    name = dataset.name.rsplit("/", 1)[1]
    values = dataset[()]
    findings.expect(values.ndim == 1 and values.size > 0, f"{where}: not one column of values")
    if not name.endswith(UNITS):
        return
    findings.expect(bool(dataset.attrs.get("unit")), f"{where}: no attribute 'unit'")
    if numpy.issubdtype(values.dtype, numpy.floating):
        findings.expect(not numpy.all(numpy.isnan(values)), f"{where}: holds no number")


def check_group(path, group, findings):
    """Checks one record: columns of one length, its sample rate, where its sensors come from."""
    columns = [item for item in group.values() if isinstance(item, h5py.Dataset)]
    where = f"{path}: {group.name}"
    findings.expect(len({len(column) for column in columns}) == 1, f"{where}: columns of unequal length")
    for column in columns:
        check_dataset(path, column, findings)
    timed = "time_s" in group or "sample_rate_hz" in group.attrs
    findings.expect(timed, f"{where}: neither 'time_s' nor attribute 'sample_rate_hz'")
    sensors = [column for column in columns if "sensor_serial" in column.attrs]
    findings.expect(bool(sensors), f"{where}: no column names its sensor's serial number")
    for column in sensors:
        findings.expect("calibration" in column.attrs, f"{path}: {column.name}: no attribute 'calibration'")


def check_cycle_file(path, findings):
    records = []
    with h5py.File(path, "r") as file:
        file.visititems(lambda _, item: records.append(item) if isinstance(item, h5py.Group) and "kind" in item.attrs
                        else None)
        findings.expect(bool(records), f"{path}: holds no record")
        for group in records:
            check_group(path, group, findings)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", metavar="DIR", type=pathlib.Path)
    folder = parser.parse_args().folder
    findings = Findings()
    cycles = check_journal(folder, findings)
    findings.expect(bool(cycles), f"{folder}: no cycle is complete")
    expected = {f"{cycle:06d}.h5" for cycle in cycles}
    present = {path.name for path in (folder / "cycles").iterdir()}
    findings.expect(present == expected, f"{folder / 'cycles'}: missing {sorted(expected - present)}, "
                                         f"unexpected {sorted(present - expected)}")
    for name in sorted(expected & present):
        check_cycle_file(folder / "cycles" / name, findings)
    for finding in findings[:MOST_SHOWN]:
        print(f"error: {finding}", file=sys.stderr)
    if findings:
        print(f"{len(findings)} findings", file=sys.stderr)
        return 1
    print(f"{folder}: {len(cycles)} cycles open with sqlite3 and h5py, and hold what the contract promises")
    return 0


if __name__ == "__main__":
    sys.exit(main())
