#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Where the measured records of others are found, and how one of ours is written."""
import os
import pathlib

import numpy

GRAVITY_M_PER_S2 = 9.80665


def source_folder():
    """The folder of the measured records: STRAINWAVE_DATA, or ../shared/data beside the checkout, or None."""
    checkout = pathlib.Path(__file__).resolve().parents[2]
    named = os.environ.get("STRAINWAVE_DATA")
    folder = pathlib.Path(named) if named else checkout.parent / "shared" / "data"
    return folder if folder.is_dir() else None


class Record:
    """One record: a name for its file, metadata, and columns of equal length by name."""

    def __init__(self, name, metadata, columns):
        lengths = {len(values) for values in columns.values()}
        if len(lengths) != 1:
            raise ValueError(f"{name}: columns of {sorted(lengths)} rows (expected one length)")
        self.name = name
        self.metadata = metadata
        self.columns = columns

    def write(self, folder):
        """Writes FOLDER/NAME.csv and returns its path."""
        path = pathlib.Path(folder) / f"{self.name}.csv"
        path.parent.mkdir(parents=True, exist_ok=True)
        rows = numpy.column_stack(list(self.columns.values()))
        with open(path, "w", encoding="utf-8") as file:
            for key, value in self.metadata.items():
                file.write(f"# {key}: {value}\n")
            file.write(",".join(self.columns) + "\n")
            line = ",".join(["%.9g"] * rows.shape[1]) + "\n"
            file.writelines(line % tuple(row) for row in rows.tolist())
        return path
