#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Wavelets and features beside PyWavelets and vectorised NumPy: one thread each, in turn, on the same
machine, in CPU time, so that whatever else runs counts less.

usage: compare_with_peers.py [--rounds N]     after: cmake --build --preset release --target predictor_benchmark

The NumPy features are `features.py` in the folder that STRAINWAVE_PEERS names, else in ../shared/peers."""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import time

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[variable] = "1"
import numpy
import pywt

ROOT = pathlib.Path(__file__).resolve().parents[2]
PEERS = pathlib.Path(os.environ.get("STRAINWAVE_PEERS") or ROOT / "../shared/peers")
PROGRAM = ROOT / "build/benchmarks/predictor_benchmark"
LEVELS = 7
SIZES = ((4, 102400), (6, 200000))


def approximations(signal):
    series = []
    for _ in range(LEVELS):
        signal = pywt.downcoef("a", signal, "sym8", "symmetric", level=1)
        series.append(signal)
    return series


def wavedec(signal):
    return pywt.wavedec(signal, "sym8", "symmetric", level=LEVELS)


def peers():
    jobs = {"Decomposes/approximations": approximations, "Decomposes/all": wavedec}
    if (PEERS / "features.py").exists():
        sys.path.insert(0, str(PEERS))
        from features import numpy_features
        jobs["ComputesTheFeatures"] = lambda signal: [numpy_features(series) for series in approximations(signal)]
    return jobs


def milliseconds(job, record):
    begin = time.process_time()
    for channel in record:
        job(channel)
    return 1e3 * (time.process_time() - begin)


def ours():
    done = subprocess.run([PROGRAM, "--benchmark_filter=Decomposes|ComputesTheFeatures", "--benchmark_format=json",
                           "--benchmark_min_time=0.1"], capture_output=True, text=True, check=True)
    return {row["name"]: row["cpu_time"] for row in json.loads(done.stdout)["benchmarks"]}


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--rounds", type=int, default=7)
    rounds = options.parse_args().rounds
    random = numpy.random.default_rng(1)
    records = {size: random.standard_normal(size) for size in SIZES}
    theirs, own = {}, {}
    for _ in range(rounds):
        for size, record in records.items():
            for name, job in peers().items():
                key = f"{name}/{size[0]}/{size[1]}"
                theirs.setdefault(key, []).append(milliseconds(job, record))
        for key, value in ours().items():
            own.setdefault(key, []).append(value)
    print(f"{'median of ' + str(rounds) + ' rounds, one thread':44} {'peer, ms':>9} {'ours, ms':>9} {'ratio':>6}")
    for key, values in theirs.items():
        peer_ms, own_ms = statistics.median(values), statistics.median(own[key])
        print(f"{key:44} {peer_ms:9.2f} {own_ms:9.2f} {peer_ms / own_ms:6.1f}")


if __name__ == "__main__":
    main()
