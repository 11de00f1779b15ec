#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A pendant stops a load run over vcan0, Modbus TCP and TCP streams: pressed, then unplugged. Each time the shafts are
safe in truth, the campaign ends with 130 and goes on when a person resumes it; at the end all load was served. A
safe-torque-off contact, which opens with the pressed key and by itself, is read through HID as is a thermometer.

  tests/vm/run.sh tests/vm/pendant_test.py build
"""
import json
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import vm_bench
from vm_bench import BENCH, SCHEDULE, check, load_served

# The drives' ramp takes 50 ms; one that was not stopped would go on for 20 s.
LONGEST_STOP_S = 1.5
# As a safety relay takes. The program asks for the stop within these: it looks every 10 ms.
RELAY_S = 0.02
AMBIENT_DEGC = 21.25
CLOSED, OPEN = b"\1", b"\0"


def with_hid(folder):
    """The bench's file with a contact and the room's thermometer on HID."""
    profiles = "../../../bench/devices/profiles/"
    text = BENCH.read_text(encoding="utf-8")
    text = text.replace("devices:\n", f"""devices:
  - {{name: contact, kind: sto_contact, profile: {profiles}hid_sto_contact.yaml}}
  - {{name: room, kind: hid, profile: {profiles}hid_thermometer.yaml}}
""").replace("device: thermometers, source: ambient_temperature_degC", "device: room, source: temperature_degC")
    text = text.replace("../../../", f"{BENCH.parents[3]}/").replace("drive.yaml}", f"{BENCH.parent}/drive.yaml}}")
    bench = folder / "bench.yaml"
    bench.write_text(text, encoding="utf-8")
    return bench


def read_once(build, bench):
    done = subprocess.run([build / "strainwave", "bench", "check", bench, "--json"], capture_output=True, text=True,
                          check=False)
    check(done.returncode == 0, f"bench check: exit code {done.returncode} {done.stderr}")
    checked = json.loads(done.stdout)
    states = {device["device"]: device["state"] for device in checked["devices"]}
    check(states["safe torque off contact"] == "closed", f"the contact is {states['safe torque off contact']}")
    check(states["room"] == "connected", f"the room's thermometer is {states['room']}")
    room = next(row for row in checked["channels"] if row["channel"] == "ambient_temperature_degC")
    check(room["good"] and room["value"] == AMBIENT_DEGC, f"it reads {room}")


def openings(folder):
    return [text for text, in vm_bench.from_journal(
        folder, "SELECT text FROM events WHERE text LIKE 'safe torque off opened%' ORDER BY id")]


def stop(what, act, campaign, devices, folder):
    vm_bench.wait_for_load(folder, devices, f"before {what}")
    vm_bench.time.sleep(4)
    acted = act()
    code = campaign.wait(60)
    check(code == 130, f"{what}: the program ends with 130 ({code})")
    since = devices.safe_since()
    check(since is not None, f"{what}: torque is off and brakes are on")
    check(acted < since < acted + LONGEST_STOP_S, f"{what}: {1e3 * (since - acted):.1f} ms from there to the stop")
    said = [line for _, line in campaign.lines.said]
    check(any("the quick-stop key was pressed, or its pendant is gone" in line for line in said), f"{what}: it says why")
    check(any("go on with: strainwave run" in line for line in said), f"{what}: it says how to go on")
    served = load_served(folder)
    check(0 < served < 20, f"{what}: {served:.1f} s of load are on record")
    return since


def main():
    build = pathlib.Path(sys.argv[1])
    scratch = pathlib.Path(tempfile.mkdtemp())
    folder, bench = scratch / "campaign", with_hid(scratch)
    pendant = vm_bench.Pendant()
    contact = vm_bench.HidDevice(b"strainwave contact", vm_bench.CONTACT, b"C1", CLOSED)
    vm_bench.HidDevice(b"strainwave thermometer", vm_bench.THERMOMETER, b"T1",
                       struct.pack(">2sh4s", b"\x80\x80", int(256 * AMBIENT_DEGC), b""))
    devices = vm_bench.Devices(build, BENCH, sys.stderr)
    read_once(build, bench)

    def run(resume):
        return vm_bench.Campaign(build, SCHEDULE, bench, folder, devices, pendant, sys.stderr, resume)

    def press():
        pressed = pendant.press(vm_bench.QUICK_STOP)
        vm_bench.time.sleep(RELAY_S)
        contact.say(OPEN)
        return pressed

    since = stop("the key pressed", press, run(False), devices, folder)
    noted = openings(folder)
    asked = re.fullmatch(r"safe torque off opened (\d+\.\d) ms after the stop was asked for", " and ".join(noted))
    check(asked and float(asked[1]) < 1e3 * LONGEST_STOP_S, f"the contact opened with it: {noted}")
    contact.say(CLOSED)
    pendant.press(0)
    vm_bench.time.sleep(2)
    check(devices.safe_since() == since, "the key released: nothing starts by itself")
    campaign = run(True)

    def open_and_unplug():
        contact.say(OPEN)
        vm_bench.time.sleep(RELAY_S)
        return pendant.unplug()

    since = stop("the pendant unplugged", open_and_unplug, campaign, devices, folder)
    check(openings(folder)[1:] == ["safe torque off opened, and nobody had asked for a stop here"],
          f"the contact had opened by itself: {openings(folder)}")
    check(any("press reset on the pendant" in line for _, line in campaign.lines.said),
          "resumed: it has waited for reset and start")
    campaign = run(True)
    check(campaign.lines.wait_for("plug the pendant in", 60) is not None, "resumed: it waits for the pendant")
    check(devices.safe_since() == since, "meanwhile the bench stands")
    campaign.pendant = pendant = vm_bench.Pendant()
    code = campaign.wait(120)
    check(code == 0, f"plugged in again, reset and started: the campaign comes to its end ({code})")
    served = load_served(folder)
    check(abs(served - 20) < 0.1, f"{served:.2f} s of load of 20 were served in all")
    check(devices.safe_since() is not None, "and the bench is safe")
    devices.quit()


if __name__ == "__main__":
    main()
