#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Files as instruments write them, 16 series of doubles each, read by the program and by pandas' C engine in turn, best
of three. The files stay in FOLDER for another run.

usage: import_pandas.py FOLDER MEGABYTES [BUILD]     Debian's python3-pandas; BUILD is build where not told"""
import pathlib
import subprocess
import sys
import time

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "bench/import"))
import instrument_files  # noqa: E402

COLUMNS, ROWS_OF_BLOCK = 16, 20000
PANDAS = """
import resource, sys, time
import pandas
begin = time.perf_counter()
table = pandas.read_csv(sys.argv[1], engine="c", comment=None)
print(time.perf_counter() - begin, table.size, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024e-6)
"""


def make_csv(path, megabytes, digits):
    rng = numpy.random.default_rng(1)
    names = ["time_s"] + [f"accel_{c}_m_per_s2" for c in range(1, COLUMNS)]
    values = rng.normal(0, 10, (ROWS_OF_BLOCK, COLUMNS))
    values[:, 0] = numpy.arange(ROWS_OF_BLOCK) / 51200
    block = "".join(",".join(f"{v:.{digits}f}" for v in row) + "\n" for row in values).encode()
    with path.open("wb") as file:
        file.write((",".join(names) + "\n").encode())
        for _ in range(max(1, int(megabytes * 1e6 / len(block)))):
            file.write(block)


def make_binary(folder, megabytes):
    values = numpy.random.default_rng(2).normal(size=int(megabytes * 1e6 / 8 / COLUMNS))
    instrument_files.mat5(folder / "double.mat", {f"accel_{c}": values for c in range(COLUMNS)})
    (folder / "double.tdms").write_bytes(instrument_files.tdms_segment(
        {f"/'m'/'accel_{c}'": (values, {"wf_increment": 1 / 51200}) for c in range(COLUMNS)}, chunks=1))
    single = (values * 1000).astype("<i2")
    (folder / "int16.tdms").write_bytes(instrument_files.tdms_segment(
        {f"/'m'/'accel_{c}'": (single, {"wf_increment": 1 / 51200}) for c in range(COLUMNS)}, chunks=1))


def main():
    folder, megabytes = pathlib.Path(sys.argv[1]), float(sys.argv[2])
    build = pathlib.Path(sys.argv[3] if len(sys.argv) > 3 else "build")
    csvs = {folder / f"digits{d}.csv": d for d in (4, 15)}
    if not (folder / "int16.tdms").exists():
        for path, digits in csvs.items():
            make_csv(path, megabytes, digits)
        make_binary(folder, megabytes)
    for path in csvs:
        pandas, ours = [], []
        for _ in range(3):
            done = subprocess.run(["/usr/bin/python3", "-c", PANDAS, str(path)], check=True, capture_output=True, text=True)
            pandas.append([float(word) for word in done.stdout.split()])
            begin = time.perf_counter()
            subprocess.run([build / "strainwave", "convert", path, "--preview"], check=True, capture_output=True)
            ours.append(time.perf_counter() - begin)
        seconds, values, peak_MB = min(pandas)
        print(f"{path.name}: {path.stat().st_size / 1e6:.0f} MB, {values / 1e6:.0f} million values: pandas {seconds:.2f} s, peak "
              f"memory {peak_MB:.0f} MB; convert --preview {min(ours):.2f} s, {seconds / min(ours):.1f} times as fast")
    print(subprocess.run([build / "benchmarks/import_benchmark", *csvs, folder / "double.mat", folder / "double.tdms",
                          folder / "int16.tdms"], check=True, capture_output=True, text=True).stdout, end="")


if __name__ == "__main__":
    main()
