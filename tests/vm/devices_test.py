#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave devices` and `strainwave bench check` on buses of the kernel: what they find of strainwave-devices and a
uhid pendant, and that nothing has moved for it; what the check says of a drive that is silent, and of a wire on which
frames go wrong.

  tests/vm/run.sh tests/vm/devices_test.py build
"""
import json
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import vm_bench
from vm_bench import BENCH, check


# Error frames of a controller that counts what goes wrong (linux/can/error.h), and what is said of it.
WIRE_TROUBLES = {"20000004#0008000000000000": "error warning: frames go wrong on the wire",
                 "20000004#0020000000000000": "error passive: many frames go wrong on the wire"}


def look(build):
    """Exit code and devices of `bench check`, the latter by their names."""
    done = subprocess.run([build / "strainwave", "bench", "check", BENCH, "--json"], capture_output=True, text=True, check=False)
    checked = json.loads(done.stdout)
    check(checked["good"] == (done.returncode == 0), f"bench check: good {checked['good']}, exit code {done.returncode}")
    return done.returncode, {device["device"]: device for device in checked["devices"]}


def look_at_a_silent_drive(build, devices):
    devices.do("drive 2 silent on")
    code, rows = look(build)
    check(code == 3, f"a drive is silent: exit code {code}")
    bad = {name: row["state"] for name, row in rows.items() if not row["good"]}
    check(list(bad) == ["load servo"], f"it is the one: {bad}")
    check("node 2" in bad["load servo"] and "the answer did not come in time" in bad["load servo"], "and it says why")
    text = subprocess.run([build / "strainwave", "bench", "check", BENCH], capture_output=True, text=True, check=False).stdout
    check(any(line.startswith("BAD   load servo ") for line in text.splitlines()), "its row is marked")
    devices.do("drive 2 silent off")


def look_at_a_bad_wire(build):
    for frame, words in WIRE_TROUBLES.items():
        with subprocess.Popen(["bash", "-c", f"while cansend vcan0 {frame}; do sleep 0.2; done"]) as wire:
            code, rows = look(build)
            wire.terminate()
        check(code == 3 and not rows["can"]["good"], f"{frame}: exit code {code}")
        check(words in rows["can"]["state"], f"can: {rows['can']['state']}")
    code, rows = look(build)
    check(code == 0, f"all is well again: {[row for row in rows.values() if not row['good']]}")


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
    look_at_a_silent_drive(build, devices)
    look_at_a_bad_wire(build)
    check(devices.safe_since() == since, "nothing has moved, and no drive was enabled")
    devices.quit()


if __name__ == "__main__":
    main()
