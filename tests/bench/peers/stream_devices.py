# SPDX-License-Identifier: Apache-2.0
"""Devices that give the samples of a record of four accelerometers: over TCP, and behind an iiod."""
import json
import pathlib
import socket
import struct
import sys
import threading
import types

import numpy

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "tests/daq/acquisition/peers"), str(ROOT / "daq/acquisition")]
import iiod_emulator  # noqa: E402
import reference_sender  # noqa: E402

CHANNELS = ["accel_x_m_per_s2", "accel_y_m_per_s2", "accel_z_m_per_s2", "accel_motor_z_m_per_s2"]
RATE_HZ, BLOCK = 25600, 512


class Device(reference_sender.Stream):
    """The reference sender with a record, over and over, in place of its ramps. It stops before block `pause_at` until
    `go` is set."""

    def __init__(self, samples, blocks, names=tuple(CHANNELS), pause_at=None, calibration=None, **faults):
        options = dict(rate=RATE_HZ, samples=BLOCK, blocks=blocks, fast=True, channels=len(names), drop=set(), corrupt=set(),
                       garbage=set(), disconnect=set()) | faults
        super().__init__(types.SimpleNamespace(**options))
        self.samples, self.names, self.pause_at, self.go = samples, names, pause_at, threading.Event()
        self.calibration = calibration or {}
        self.server = socket.create_server(("127.0.0.1", 0))
        self.port = self.server.getsockname()[1]
        reference_sender.hello, reference_sender.block = self.hello, self.block
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def hello(self, options):
        channels = [{"name": name, "unit": "m/s^2", "calibration": self.calibration} for name in self.names]
        text = json.dumps({"name": "front end", "type": "float32", "rate_hz": options.rate, "channels": channels,
                           "most_samples_a_block": BLOCK})
        return reference_sender.message(reference_sender.HELLO, text.encode())

    def block(self, first, options):
        places = numpy.arange(first, first + BLOCK) % self.samples.shape[0]
        head = struct.pack("<QqII", first, int(first * 1e9 / options.rate), BLOCK, 0)
        return reference_sender.message(reference_sender.BLOCK, head + self.samples[places].astype("<f4").tobytes())

    def wait_for(self, number, connection):
        if self.pause_at is not None and number == self.pause_at + 1:
            while not self.go.wait(0.5):  # it lives, and has nothing to say
                alive = struct.pack("<Qq", self.number * BLOCK, 0)
                self.send(connection, reference_sender.message(reference_sender.KEEP_ALIVE, alive))

    def run(self):
        with self.server:
            while True:
                connection, _ = self.server.accept()
                with connection:
                    try:
                        if self.serve(connection):
                            return
                    except ConnectionError:
                        pass


class Iiod(iiod_emulator.Server):
    """An iiod whose accelerometer gives the samples of a record, in counts of 2^-20 m/s²."""

    attributes = {"scale": repr(2.0 ** -20), "sampling_frequency": str(RATE_HZ)}

    def __init__(self, samples):
        super().__init__(("127.0.0.1", 0), iiod_emulator.Client)
        self.samples = numpy.rint(samples * 2.0 ** 20).astype("<i4")
        self.options = types.SimpleNamespace(in_real_time=False, skip_after=0, blocks=len(samples))
        threading.Thread(target=self.serve_forever, daemon=True).start()

    def context(self):
        return iiod_emulator.describe([name.removesuffix("_m_per_s2") for name in CHANNELS], "le:s32/32&gt;&gt;0", False)

    def sample(self, n):
        return self.samples[n % len(self.samples)].tobytes()
