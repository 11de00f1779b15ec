#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What was said on the bus at the start is said again, by canplayer, while the shafts turn: commands to the nodes, SDO,
controlwords and boot-ups of another time. The bench stops safe and says why; on a quiet bus the campaign goes on, the time
of day is set forward and back meanwhile, and at the end all load was served.

  tests/vm/run.sh tests/vm/replay_test.py build
"""
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import vm_bench
from vm_bench import BENCH, SCHEDULE, check, listening_to, load_served

# As pendant_test has it, from the first frame of the other time on.
LONGEST_STOP_S = 1.5


def main():
    build = pathlib.Path(sys.argv[1])
    scratch = pathlib.Path(tempfile.mkdtemp())
    folder, log = scratch / "campaign", scratch / "bus.log"
    vm_bench.into_memory("/usr/bin/candump", "/usr/bin/cansend", "/usr/bin/canplayer")
    pendant = vm_bench.Pendant()
    devices = vm_bench.Devices(build, BENCH, sys.stderr)

    def run(resume):
        return vm_bench.Campaign(build, SCHEDULE, BENCH, folder, devices, pendant, sys.stderr, resume)

    with listening_to(log):
        campaign = run(False)
        check(devices.wait_until(safe=False, seconds=120), "the shafts turn")
    vm_bench.wait_for_load(folder, devices, "in the load run")
    said = log.read_text(encoding="utf-8").splitlines()
    check(any(" 000#8" in line for line in said), f"{len(said)} frames were heard, the reset of a node among them")
    vm_bench.time.sleep(4)
    began = vm_bench.time.monotonic()
    with subprocess.Popen(["canplayer", "-I", log]) as playing:
        code = campaign.wait(60)
        playing.terminate()
    check(code in (1, 3), f"they were said again: the program ends as after a fault ({code})")
    since = devices.safe_since()
    check(since is not None and since < began + LONGEST_STOP_S,
          f"torque is off and brakes are on {1e3 * ((since or 0) - began):.1f} ms after the first of them")
    said = [line for _, line in campaign.lines.said]
    check(any("the drive started anew while in use" in line for line in said), "it says why")
    served = load_served(folder)
    check(0 < served < 20, f"{served:.1f} s of load are on record")

    campaign = run(True)
    vm_bench.wait_for_load(folder, devices, "resumed on a quiet bus")
    for hours in (3, -5):
        vm_bench.time.clock_settime(vm_bench.time.CLOCK_REALTIME, vm_bench.time.time() + 3600 * hours)
        vm_bench.time.sleep(2)
    code = campaign.wait(120)
    check(code == 0, f"the time of day jumped by 3 and by -5 hours: the campaign comes to its end ({code})")
    check(abs(load_served(folder) - 20) < 0.1, f"{load_served(folder):.2f} s of load of 20 were served in all")
    check(devices.safe_since() is not None, "and the bench is safe")
    devices.quit()


if __name__ == "__main__":
    main()
