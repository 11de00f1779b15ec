# SPDX-License-Identifier: Apache-2.0
"""A monitor of an exported predictor, the record that it replays, and a broker with a host that listens."""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import exported_campaign
import h5py
import mqtt_peer
import numpy
from stream_devices import BLOCK, CHANNELS


class MonitorTest(unittest.TestCase):
    program, folder = "", pathlib.Path()  # of the run

    @classmethod
    def setUpClass(cls):
        cls.campaign, cls.exported = exported_campaign.make(cls.program, cls.folder)
        cls.record = cls.campaign / "cycles" / "000010.h5"
        with h5py.File(cls.record) as file:
            record = file["measurement_rotation/vibration"]
            cls.samples = numpy.stack([record[channel][:] for channel in CHANNELS], axis=1)
        cls.recipe = json.loads((cls.exported / "recipe.json").read_text())["recipe"]
        cls.window = cls.recipe["least_samples"]
        assert cls.window == len(cls.samples) and cls.window % BLOCK == 0
        cls.blocks = cls.window // BLOCK  # of a window

    def setUp(self):
        self.running = []

    def tearDown(self):
        for process in self.running:
            if process.poll() is None:
                process.kill()
            process.wait()
            process.stderr_file.close()
            process.results_file.close()

    def settings(self, text):
        path = self.folder / f"{self.id().split('.')[-1]}.yaml"
        path.write_text("monitor: 1\n" + text)
        return path

    def start(self, *arguments, environment=None):
        """A monitor that runs; `said` and `results` read what it has written so far."""
        number = len(self.running)
        errors, results = (open(self.folder / f"{self.id()}-{number}.{kind}", "w+") for kind in ("errors", "results"))
        process = subprocess.Popen([self.program, "monitor", str(self.exported), *map(str, arguments), "--json"], stdout=results,
                                   stderr=errors, text=True, env=os.environ | (environment or {}))
        process.stderr_file, process.results_file = errors, results
        process.said = lambda: pathlib.Path(errors.name).read_text()
        process.results = lambda: [json.loads(line) for line in pathlib.Path(results.name).read_text().splitlines()
                                   if line.endswith("}")]
        self.running.append(process)
        return process

    def predicted(self):
        done = subprocess.run([self.program, "monitor", self.exported, "--replay", self.record, "--pace", "max", "--json"],
                              capture_output=True, text=True, check=True)
        return json.loads(done.stdout)["values"]

    def broker(self, more=""):
        broker = mqtt_peer.Broker(more)
        broker.start()
        self.addCleanup(broker.close)
        plain = int(found.group(1)) if (found := re.search(r"listener (\d+)", more)) else broker.port
        return broker, self.listener(broker, plain)

    def listener(self, broker, port):
        host = broker.connected(lambda: mqtt_peer.Client(port, "listener"))
        self.addCleanup(host.close)
        host.subscribe("spBv1.0/lab/#")
        return host

    @staticmethod
    def messages_of(host):
        return [(topic.split("/")[2], mqtt_peer.decode(payload)) for topic, payload, _ in host.poll(0.05)]

    def data_of(self, host):
        return [payload for kind, payload in self.messages_of(host) if kind == "NDATA"]


def main():
    """All tests of the program that is the first argument."""
    MonitorTest.program = os.path.abspath(sys.argv.pop(1))
    with tempfile.TemporaryDirectory() as folder:
        MonitorTest.folder = pathlib.Path(folder)
        unittest.main()
