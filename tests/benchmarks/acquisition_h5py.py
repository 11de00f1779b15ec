#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The blocks of acquisition_benchmark.cc written with h5py: 16 channels x 51.2 kHz float32, 512 samples a block,
in real time and as fast as it goes.

usage: acquisition_h5py.py FOLDER SECONDS [SECONDS_AT_FULL_SPEED]
"""
import os
import resource
import sys
import time

import h5py
import numpy as np

CHANNELS, RATE, BLOCK = 16, 51200, 512
CHUNK = (1 << 20) // (4 * CHANNELS)
BLOCKS = np.dtype([("first_sample", "u8"), ("device_time_ns", "i8"), ("arrival_ns", "i8"), ("samples", "u4")])


def cpu_s():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


class Recorder:
    """The same datasets with the same chunks, checksums and flushes."""

    def __init__(self, path):
        self.path = path
        self.file = h5py.File(path, "w", libver="latest")
        self.samples = self.file.create_dataset("samples", (0, CHANNELS), "f4", maxshape=(None, CHANNELS),
                                                chunks=(CHUNK, CHANNELS), fletcher32=True)
        self.blocks = self.file.create_dataset("blocks", (0,), BLOCKS, maxshape=(None,), chunks=(1024,),
                                               fletcher32=True)
        self.file.swmr_mode = True

    def push(self, block):
        at = len(self.samples)
        self.samples.resize(at + BLOCK, axis=0)
        self.samples[at:] = block
        rows = len(self.blocks)
        self.blocks.resize(rows + 1, axis=0)
        self.blocks[rows] = (at, at * 1e9 / RATE, time.monotonic_ns(), BLOCK)
        if (at + BLOCK) // RATE != at // RATE:
            self.samples.flush()
            self.blocks.flush()

    def finish(self):
        self.file.close()
        fd = os.open(self.path, os.O_RDONLY)
        os.fsync(fd)
        os.close(fd)


def main():
    folder, seconds = sys.argv[1], float(sys.argv[2])
    block = np.random.default_rng(1).normal(size=(BLOCK, CHANNELS)).astype("f4")
    recorder = Recorder(os.path.join(folder, "h5py_paced.h5"))
    before, begin = cpu_s(), time.monotonic()
    for i in range(int(seconds * RATE / BLOCK)):
        time.sleep(max(0.0, begin + (i + 1) * BLOCK / RATE - time.monotonic()))
        recorder.push(block)
    share = (cpu_s() - before) / (time.monotonic() - begin)
    recorder.finish()
    peak_MB = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e6
    print(f"h5py in real time, {seconds:g} s: CPU {100 * share:.2f} % of one core, peak memory {peak_MB:.1f} MB")
    if len(sys.argv) < 4:
        return
    recorder = Recorder(os.path.join(folder, "h5py_full.h5"))
    before, begin, blocks = cpu_s(), time.monotonic(), 0
    while time.monotonic() - begin < float(sys.argv[3]):
        recorder.push(block)
        blocks += 1
    recorder.finish()
    wall, data = time.monotonic() - begin, blocks * BLOCK / RATE
    print(f"h5py at full speed, {wall:.1f} s: {data / wall:.1f} x real time with fsync, "
          f"{data * RATE * CHANNELS * 4 / 1e6 / wall:.1f} MB/s, {1e3 * (cpu_s() - before) / data:.2f} ms of CPU "
          "a second of data")


if __name__ == "__main__":
    main()
