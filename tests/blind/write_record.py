# SPDX-License-Identifier: Apache-2.0
"""Writes a drawn case: the record as CSV, the truth as JSON in another folder."""
import json
import pathlib


def record_text(metadata, columns):
    """`columns`: name -> list of words, or (values, format)."""
    lines = ["# %s: %s" % item for item in metadata.items()]
    lines.append(",".join(columns))
    words = [column if isinstance(column, list) else [column[1] % value for value in column[0].tolist()]
             for column in columns.values()]
    lines += map(",".join, zip(*words))
    return "\n".join(lines) + "\n"


def write_case(folder, number, case):
    """Returns the paths of record and truth."""
    folder = pathlib.Path(folder)
    record = folder / "records" / ("case_%04d.csv" % number)
    truth = folder / "truth" / ("case_%04d.json" % number)
    for path in (record, truth):
        path.parent.mkdir(parents=True, exist_ok=True)
    record.write_text(record_text(case.metadata, case.columns), encoding="utf-8")
    truth.write_text(json.dumps(case.truth, indent=1) + "\n", encoding="utf-8")
    return record, truth
