#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Converts measured records of others into record files of ours.

  tests/data/convert.py --out DIR [--source DIR] [NAME...]

Without NAME all folders are converted. The source is STRAINWAVE_DATA, or ../shared/data beside the checkout.
"""
import argparse
import pathlib
import sys

import records
import sources


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(sources.SOURCES)}")
    parser.add_argument("--out", required=True, type=pathlib.Path, help="folder that gets NAME/*.csv")
    parser.add_argument("--source", type=pathlib.Path, default=records.source_folder(), help="folder of the records")
    arguments = parser.parse_args()
    if arguments.source is None:
        sys.exit("convert.py: error: there are no measured records (expected STRAINWAVE_DATA or --source)")
    unknown = set(arguments.names) - set(sources.SOURCES)
    if unknown:
        parser.error(f"there is no folder {', '.join(sorted(unknown))}")
    for name in arguments.names or sources.SOURCES:
        count = sum(1 for record in sources.read(name, arguments.source) if record.write(arguments.out / name))
        print(f"{name}: {count} records in {arguments.out / name}")


if __name__ == "__main__":
    main()
