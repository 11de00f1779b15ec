#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""An epoch of the two networks of docs/sources.md#shivam-2023, and one record through `ann`, beside PyTorch: in
turn, on the same machine; PyTorch at one thread and at all, of which the better counts.

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


def timed(job):
    wall, cpu = time.perf_counter(), time.process_time()
    job()
    return 1e3 * (time.perf_counter() - wall), 1e3 * (time.process_time() - cpu)


def epoch(model, batch, x, y):
    optimizer = torch.optim.Adam(model.parameters(), lr=1e-3)
    order = torch.randperm(RECORDS)
    for first in range(0, RECORDS, batch):
        rows = order[first:first + batch]
        xb, yb = (x, y) if batch >= RECORDS else (x[rows], y[rows])
        optimizer.zero_grad(set_to_none=True)
        (100.0 * torch.mean(torch.abs((yb - model(xb)) / yb))).backward()
        optimizer.step()


def thousand_records(model, x):
    with torch.no_grad():
        for _ in range(1000):
            model(x[:1])


def ours():
    done = subprocess.run([PROGRAM, "--benchmark_filter=TrainsAnEpoch|PredictsOneRecord", "--benchmark_format=json",
                           "--benchmark_min_time=0.05"], capture_output=True, text=True, check=True)
    return {row["name"]: row for row in json.loads(done.stdout)["benchmarks"]}


# Name, what PyTorch does, our benchmark at one thread and at all.
def jobs(x, y):
    first, second = ann(), cnn()
    return (("ann, batch 32, ms", lambda: epoch(first, 32, x, y), "ann/32", "ann_threads/32/real_time"),
            ("ann, full batch, ms", lambda: epoch(first, RECORDS, x, y), "ann/2500", "ann_threads/2500/real_time"),
            ("cnn, batch 32, ms", lambda: epoch(second, 32, x, y), "cnn/32", "cnn_threads/32/real_time"),
            ("ann, one record, us", lambda: thousand_records(first, x), None, None))


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--rounds", type=int, default=5)
    rounds = options.parse_args().rounds
    torch.manual_seed(1)
    x, y = torch.randn(RECORDS, INPUTS), 3.0 + torch.rand(RECORDS, OUTPUTS)
    rows = jobs(x, y)
    cpu, wall, own_cpu, own_wall = {}, {}, {}, {}
    for _ in range(rounds):
        for threads in sorted({1, os.cpu_count()}):
            torch.set_num_threads(threads)
            for name, job, _, _ in rows:
                wall_ms, cpu_ms = timed(job)
                wall.setdefault((name, threads), []).append(wall_ms)
                if threads == 1:
                    cpu.setdefault(name, []).append(cpu_ms)
        results = ours()
        for name, _, one, every in rows:
            single = results[f"TrainsAnEpoch/{one}" if one else "PredictsOneRecord"]
            own_cpu.setdefault(name, []).append(single["cpu_time"])
            threaded = results[f"TrainsAnEpoch/{every}"] if every else single
            own_wall.setdefault(name, []).append(min(single["real_time"], threaded["real_time"]))
    print(f"{f'median of {rounds} rounds':24} {'CPU, one thread:':>17} {'PyTorch':>9} {'ours':>9} {'ratio':>6} "
          f"{'wall, best threads:':>20} {'PyTorch':>9} {'ours':>9} {'ratio':>6}")
    middle = statistics.median
    for name, *_ in rows:
        peer_wall = min(middle(values) for (job, _), values in wall.items() if job == name)
        print(f"{name:42} {middle(cpu[name]):9.1f} {middle(own_cpu[name]):9.1f} "
              f"{middle(cpu[name]) / middle(own_cpu[name]):6.2f} {'':20} {peer_wall:9.1f} {middle(own_wall[name]):9.1f} "
              f"{peer_wall / middle(own_wall[name]):6.2f}")


if __name__ == "__main__":
    main()
