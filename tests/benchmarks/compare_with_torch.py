#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""An epoch of the paper's two networks, and one record through `ann`, beside PyTorch: in turn, on the same
machine; PyTorch at one thread and at all, of which the better counts.

usage: compare_with_torch.py [--rounds N]     after: cmake --build --preset release --target predictor_benchmark

Debian's PyTorch: apt-get install python3-torch. Without it the comparison is skipped."""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import time

# PyTorch's fastest of Debian's BLAS builds, if it is there; read when the process starts.
OPENBLAS = "/usr/lib/x86_64-linux-gnu/openblas-openmp"
if os.path.isdir(OPENBLAS) and OPENBLAS not in os.environ.get("LD_LIBRARY_PATH", ""):
    os.environ["LD_LIBRARY_PATH"] = OPENBLAS
    os.execv(sys.executable, [sys.executable, *sys.argv])
try:
    import torch
    from torch import nn
except ImportError:
    print("skipped, because /usr/bin/python3 has no torch (apt-get install python3-torch)")
    sys.exit(0)

PROGRAM = pathlib.Path(__file__).resolve().parents[2] / "build/benchmarks/predictor_benchmark"
RECORDS, INPUTS, OUTPUTS = 2500, 204, 4


class Series(nn.Module):
    def forward(self, x):
        return x.unsqueeze(1)


class Mean(nn.Module):
    def forward(self, x):
        return x.mean(dim=2)


def ann():
    sizes, layers = [INPUTS, 500, 500, 200, 100], []
    for size, after in zip(sizes, sizes[1:]):
        layers += [nn.Linear(size, after), nn.Sigmoid()]
    return nn.Sequential(*layers, nn.Linear(100, OUTPUTS))


def cnn():
    return nn.Sequential(
        Series(), nn.Conv1d(1, 128, 6), nn.ReLU(), nn.Conv1d(128, 64, 3), nn.ReLU(), nn.MaxPool1d(3, 2),
        nn.Conv1d(64, 64, 3), nn.ReLU(), nn.MaxPool1d(3, 2), nn.Conv1d(64, 128, 3), nn.ReLU(), Mean(),
        nn.Linear(128, 128), nn.ReLU(), nn.Linear(128, OUTPUTS))


def epoch_ms(model, batch, x, y):
    optimizer = torch.optim.Adam(model.parameters(), lr=1e-3)
    order = torch.randperm(RECORDS)
    begin = time.perf_counter()
    for first in range(0, RECORDS, batch):
        rows = order[first:first + batch]
        xb, yb = (x, y) if batch >= RECORDS else (x[rows], y[rows])
        optimizer.zero_grad(set_to_none=True)
        (100.0 * torch.mean(torch.abs((yb - model(xb)) / yb))).backward()
        optimizer.step()
    return 1e3 * (time.perf_counter() - begin)


def record_us(model, x):
    with torch.no_grad():
        begin = time.perf_counter()
        for _ in range(200):
            model(x[:1])
        return 1e6 * (time.perf_counter() - begin) / 200


def ours():
    done = subprocess.run([PROGRAM, "--benchmark_filter=TrainsAnEpoch|PredictsOneRecord", "--benchmark_format=json",
                           "--benchmark_min_time=0.05"], capture_output=True, text=True, check=True)
    return {row["name"]: row["real_time"] for row in json.loads(done.stdout)["benchmarks"]}


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--rounds", type=int, default=5)
    rounds = options.parse_args().rounds
    torch.manual_seed(1)
    x, y = torch.randn(RECORDS, INPUTS), 3.0 + torch.rand(RECORDS, OUTPUTS)
    networks = {"ann": ann(), "cnn": cnn()}
    jobs = {"ann, batch 32": ("ann", 32), "ann, full batch": ("ann", RECORDS), "cnn, batch 32": ("cnn", 32)}
    theirs, own = {}, {}
    for _ in range(rounds):
        for threads in sorted({1, os.cpu_count()}):
            torch.set_num_threads(threads)
            for name, (network, batch) in jobs.items():
                theirs.setdefault((name, threads), []).append(epoch_ms(networks[network], batch, x, y))
            theirs.setdefault(("ann, one record", threads), []).append(record_us(networks["ann"], x))
        for name, value in ours().items():
            own.setdefault(name, []).append(value)
    rows = {"ann, batch 32": ("TrainsAnEpoch/ann", "/32"), "ann, full batch": ("TrainsAnEpoch/ann", "/2500"),
            "cnn, batch 32": ("TrainsAnEpoch/cnn", "/32")}
    print(f"{'median of ' + str(rounds) + ' rounds, wall time':34} {'PyTorch, 1; all threads':>24} "
          f"{'ours, 1; all threads':>22} {'ratio of the better':>20}")
    for name in [*rows, "ann, one record"]:
        peer = [statistics.median(values) for (job, _), values in theirs.items() if job == name]
        if name in rows:
            stem, batch = rows[name]
            mine = [statistics.median(own[stem + batch]), statistics.median(own[f"{stem}_threads{batch}/real_time"])]
        else:
            mine = [statistics.median(own["PredictsOneRecord"])]
        unit = "us" if name == "ann, one record" else "ms"
        print(f"{name + ', ' + unit:34} {'; '.join(f'{value:.1f}' for value in peer):>24} "
              f"{'; '.join(f'{value:.1f}' for value in mine):>22} {min(peer) / min(mine):20.2f}")


if __name__ == "__main__":
    main()
