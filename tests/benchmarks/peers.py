#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The work of tests/benchmarks/run by PyWavelets, NumPy and PyTorch, once: JSON, by row [CPU ms of one thread, wall ms of
the better number of threads]. Rows whose peer is not there are missing.

The NumPy features are `features.py` in the folder that STRAINWAVE_PEERS names, else in ../shared/peers. PyTorch is
Debian's: apt-get install python3-torch libopenblas0-openmp."""
import json
import os
import pathlib
import sys
import time

# PyTorch's fastest of Debian's BLAS builds, if it is there; read when the process starts.
OPENBLAS = "/usr/lib/x86_64-linux-gnu/openblas-openmp"
if os.path.isdir(OPENBLAS) and OPENBLAS not in os.environ.get("LD_LIBRARY_PATH", ""):
    os.environ["LD_LIBRARY_PATH"] = OPENBLAS
    os.execv(sys.executable, [sys.executable, *sys.argv])

import numpy  # noqa: E402
import pywt  # noqa: E402

try:
    import torch
    from torch import nn
except ImportError:
    torch = None

ROOT = pathlib.Path(__file__).resolve().parents[2]
PEERS = pathlib.Path(os.environ.get("STRAINWAVE_PEERS") or ROOT / "../shared/peers")
LEVELS, CHANNELS, SAMPLES = 7, 4, 102400
RECORDS, INPUTS, OUTPUTS, FORWARDS = 2500, 204, 4, 300


def timed(job):
    wall, cpu = time.perf_counter(), time.process_time()
    job()
    return 1e3 * (time.process_time() - cpu), 1e3 * (time.perf_counter() - wall)


def approximations(signal):
    series = []
    for _ in range(LEVELS):
        signal = pywt.downcoef("a", signal, "sym8", "symmetric", level=1)
        series.append(signal)
    return series


def wavelet_rows():
    record = numpy.random.default_rng(1).standard_normal((CHANNELS, SAMPLES))
    jobs = {"approximations": approximations, "all": lambda signal: pywt.wavedec(signal, "sym8", "symmetric", level=LEVELS)}
    if (PEERS / "features.py").exists():
        sys.path.insert(0, str(PEERS))
        from features import numpy_features
        jobs["features"] = lambda signal: [numpy_features(series) for series in approximations(signal)]
    return {name: timed(lambda job=job: [job(channel) for channel in record]) for name, job in jobs.items()}


def ann():
    sizes, layers = [INPUTS, 500, 500, 200, 100], []
    for size, after in zip(sizes, sizes[1:]):
        layers += [nn.Linear(size, after), nn.Sigmoid()]
    return nn.Sequential(*layers, nn.Linear(100, OUTPUTS))


def cnn():
    class Mean(nn.Module):
        def forward(self, x):
            return x.mean(dim=2)
    return nn.Sequential(
        nn.Unflatten(1, (1, INPUTS)), nn.Conv1d(1, 128, 6), nn.ReLU(), nn.Conv1d(128, 64, 3), nn.ReLU(), nn.MaxPool1d(3, 2),
        nn.Conv1d(64, 64, 3), nn.ReLU(), nn.MaxPool1d(3, 2), nn.Conv1d(64, 128, 3), nn.ReLU(), Mean(),
        nn.Linear(128, 128), nn.ReLU(), nn.Linear(128, OUTPUTS))


def epoch(model, batch, x, y):
    optimizer = torch.optim.Adam(model.parameters(), lr=1e-3)
    order = torch.randperm(RECORDS)
    for first in range(0, RECORDS, batch):
        rows = order[first:first + batch]
        xb, yb = (x, y) if batch >= RECORDS else (x[rows], y[rows])
        optimizer.zero_grad(set_to_none=True)
        (100.0 * torch.mean(torch.abs((yb - model(xb)) / yb))).backward()
        optimizer.step()


def one_by_one(model, x):
    with torch.no_grad():
        for _ in range(FORWARDS):
            model(x[:1])


def network_rows():
    torch.manual_seed(1)
    x, y = torch.randn(RECORDS, INPUTS), 3.0 + torch.rand(RECORDS, OUTPUTS)
    first, second = ann(), cnn()
    jobs = {"ann_32": lambda: epoch(first, 32, x, y), "ann_2500": lambda: epoch(first, RECORDS, x, y),
            "cnn_32": lambda: epoch(second, 32, x, y), "ann_one": lambda: one_by_one(first, x)}
    rows = {}
    for threads in sorted({1, os.cpu_count()}):
        torch.set_num_threads(threads)
        for name, job in jobs.items():
            times = numpy.divide(timed(job), FORWARDS if name == "ann_one" else 1)
            cpu, wall = rows.get(name, times)
            rows[name] = [float(cpu), float(min(wall, times[1]))]
    return rows


def main():
    rows = wavelet_rows()
    if torch is not None:
        rows |= network_rows()
    print(json.dumps(rows))


if __name__ == "__main__":
    main()
