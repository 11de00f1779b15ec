#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave devices` and `strainwave bench check` on buses of the kernel: what they find of strainwave-devices and a
uhid pendant, and that nothing has moved for it.

  tests/vm/run.sh tests/vm/devices_test.py build
"""
import json
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import vm_bench
from vm_bench import BENCH, check


def main():
    build = pathlib.Path(sys.argv[1])
    pendant = vm_bench.Pendant()
    devices = vm_bench.Devices(build, BENCH, sys.stderr)
    since = devices.safe_since()

    def ask(*arguments):
        done = subprocess.run([build / "strainwave", *arguments], capture_output=True, text=True, check=False)
        check(done.returncode == 0, f"strainwave {' '.join(map(str, arguments))}: {done.returncode} {done.stderr}")
        return done.stdout

    found = json.loads(ask("devices", BENCH, "--modbus", "tcp:127.0.0.1:1502", "--json"))
    nodes = {node["node"]: node for node in found["can"]["devices"] if node["interface"] == "vcan0"}
    check(sorted(nodes) == [1, 2], f"CAN: nodes {sorted(nodes)} of vcan0")
    for node in nodes.values():
        check((node["vendor"], node["what"]) == ("00005357h", "servo drive (CiA 402)"), f"{node['where']}: {node['what']}")
        check(pathlib.Path(node["profile"]).name in ("drive.yaml", "strainwave_drive.yaml"), f"described by {node['profile']}")
    units = [unit["unit"] for unit in found["modbus"]["devices"]]
    check(set(units) == {1}, f"Modbus: units {units}, by address and by the bench file")
    keys = [device for device in found["hid"]["devices"] if device["serial"] == "P1"]
    check(len(keys) == 1, f"HID: {[device['where'] for device in found['hid']['devices']]}")
    check((keys[0]["vendor"], keys[0]["product"]) == ("1209", "5701"), f"{keys[0]['what']}")
    check(keys[0]["profile"].endswith("hid_pendant.yaml"), f"described by {keys[0]['profile']}")
    check(any("vcan1" in note for note in found["can"]["notes"]), "CAN: vcan1 is looked at, and nobody is there")
    check(any("avahi does not answer" in note for note in found["iio"]["notes"]), f"iio: why none is there: {found['iio']}")
    cameras = [(camera["driver"], camera["where"]) for camera in found["camera"]["devices"]]
    check(cameras == [("vivid", "/dev/video0")], f"cameras: {cameras}")

    pendant.unplug()
    left = json.loads(ask("devices", "--json"))
    check(not any(device["serial"] == "P1" for device in left["hid"]["devices"]), "HID: gone when it is unplugged")

    pendant = vm_bench.Pendant()
    print(ask("bench", "check", BENCH))
    check(devices.safe_since() == since, "nothing has moved, and no drive was enabled")
    devices.quit()


if __name__ == "__main__":
    main()
