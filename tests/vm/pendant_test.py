#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A pendant stops a load run over vcan0, Modbus TCP and TCP streams: pressed, then unplugged. Each time the shafts are
safe in truth, the campaign ends with 130 and goes on when a person resumes it; at the end all load was served.

  tests/vm/run.sh tests/vm/pendant_test.py build
"""
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import vm_bench
from vm_bench import BENCH, SCHEDULE, check, load_served

# The drives' ramp takes 50 ms; one that was not stopped would go on for 20 s.
LONGEST_STOP_S = 1.5


def stop(what, act, campaign, devices, folder):
    check(devices.wait_until(safe=False, seconds=120), f"before {what}: the shafts turn")
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
    folder = pathlib.Path(tempfile.mkdtemp()) / "campaign"
    pendant = vm_bench.Pendant()
    devices = vm_bench.Devices(build, BENCH, sys.stderr)

    def run(resume):
        return vm_bench.Campaign(build, SCHEDULE, BENCH, folder, devices, pendant, sys.stderr, resume)

    since = stop("the key pressed", lambda: pendant.press(vm_bench.QUICK_STOP), run(False), devices, folder)
    pendant.press(0)
    vm_bench.time.sleep(2)
    check(devices.safe_since() == since, "the key released: nothing starts by itself")
    campaign = run(True)
    since = stop("the pendant unplugged", pendant.unplug, campaign, devices, folder)
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
