#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What a monitor publishes and what `export` writes, read by packages of npm: ONNX Runtime, sparkplug-payload, modbus-serial;
metrics by Prometheus' own promtool.

usage: npm_peers_test.py PROGRAM NPM_FOLDER     exit code 77: skipped, a peer is not there"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "peers"))
import needed  # noqa: E402
from waiting import until  # noqa: E402

with needed.peers("/usr/sbin/mosquitto", "/usr/bin/node"):
    import monitor_fixture

SCRIPTS = pathlib.Path(__file__).resolve().parents[1] / "npm"
NPM = ""


def node(script, *arguments, said=None):
    done = subprocess.run(["/usr/bin/node", SCRIPTS / script, *map(str, arguments)], input=said, capture_output=True, text=True,
                          check=False, env=os.environ | {"STRAINWAVE_NPM": NPM})
    assert done.returncode == 0, done.stderr
    return done.stdout


class Peers(monitor_fixture.MonitorTest):
    def need(self, package):
        if not (pathlib.Path(NPM) / "node_modules" / package).exists():
            self.skipTest(f"skipped, because {NPM} has no {package}")

    def test_onnx_runtime_gives_what_was_trained_alone_and_together(self):
        self.need("onnxruntime-node")
        said = json.loads(node("onnx_runtime.mjs", self.exported / "model.onnx", self.exported / "recipe.json"))
        golden, together = said["golden"], said["together"]
        self.assertGreater(len(golden), 1)
        outputs = len(golden[0]["prediction"])
        self.assertEqual(together["prediction"]["dims"], [len(golden), outputs])
        self.assertEqual(together["distance"]["dims"], [len(golden), 1])
        for k, (row, alone) in enumerate(zip(golden, said["alone"], strict=True)):
            for name, width in (("prediction", outputs), ("half_width", outputs), ("distance", 1)):
                expected = row[name] if isinstance(row[name], list) else [row[name]]
                batch = together[name]["values"][k * width:(k + 1) * width]
                for got in (alone[name]["values"], batch):
                    for value, wanted in zip(got, expected, strict=True):
                        # Float against double: rounding of a few hundred operations (ten times in squares).
                        self.assertAlmostEqual(value, wanted, delta=1e-4 * abs(wanted) + 1e-12, msg=name)

    def test_sparkplug_payload_reads_births_and_data(self):
        self.need("sparkplug-payload")
        broker, host = self.broker()
        path = self.settings(f"mqtt:\n  port: {broker.port}\n  group: lab\n  node: bench\n")
        monitor = self.start("--replay", self.record, "--pace", "max", "--settings", path, "--linger", 30)
        self.assertEqual(monitor.wait(60), 0, monitor.said())
        payloads = {}
        until(lambda: payloads.update((topic.split("/")[2], bytes(payload)) for topic, payload, _ in host.poll(0.05))
              or "NDEATH" in payloads)
        lines = node("sparkplug_payload.mjs", said="".join(payloads[kind].hex() + "\n" for kind in ("NBIRTH", "NDATA")))
        birth, data = (json.loads(line)["metrics"] for line in lines.splitlines())
        types = {metric["name"]: metric["type"] for metric in birth}
        self.assertTrue(set(types.values()) <= {"Int64", "UInt64", "Double", "String", "Boolean"}, types)
        values = {metric["name"]: metric["value"] for metric in data}
        result = monitor.results()[-1]
        self.assertEqual(values["Window"], result["window"])
        for name, value in result["values"].items():
            self.assertEqual(values[f"{name}/Value"], value["value"])
            self.assertEqual([m["properties"]["Quality"]["value"] for m in data if m["name"] == f"{name}/Value"], [192])

    def ports(self):
        path = self.settings("modbus:\n  port: 0\nprometheus:\n  port: 0\n")
        monitor = self.start("--replay", self.record, "--rounds", 100000, "--pace", 20, "--settings", path)
        until(monitor.results)

        def port(pattern):
            return int(until(lambda: re.search(pattern, monitor.said())).group(1))
        return monitor, port(r"modbus: .* port (\d+)"), port(r"prometheus: http://127\.0\.0\.1:(\d+)/")

    def test_modbus_serial_reads_the_table_and_a_counter_that_runs(self):
        self.need("modbus-serial")
        monitor, port, _ = self.ports()
        said = json.loads(node("modbus_serial.mjs", port, 28))
        self.assertEqual(said["registers"][0], 1)
        until(lambda: json.loads(node("modbus_serial.mjs", port, 28))["registers"][13] != said["registers"][13])
        values = [value["value"] for result in monitor.results() for value in result["values"].values()]
        if said["registers"][1] == 1:
            self.assertTrue(any(abs(float(said["floats"][1]) - value) < 1e-6 * abs(value) for value in values))

    def test_promtool_finds_nothing_to_mend(self):
        promtool = shutil.which("promtool")
        if not promtool:
            self.skipTest("skipped, because there is no promtool (Debian's package prometheus)")
        _, _, port = self.ports()
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics", timeout=30) as answer:
            page = answer.read()
        done = subprocess.run([promtool, "check", "metrics"], input=page, capture_output=True, check=False)
        self.assertEqual((done.returncode, done.stdout + done.stderr), (0, b""))


if __name__ == "__main__":
    NPM = os.path.abspath(sys.argv.pop(2))
    monitor_fixture.main()
