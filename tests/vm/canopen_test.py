#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What candump hears of strainwave and strainwave-devices on vcan0 - nodes that are reset, a start, a load run, a fault of
one drive, and the start after it - keeps the rules of canopen_rules.py.

  tests/vm/run.sh tests/vm/canopen_test.py build [CAPTURE]      CAPTURE: where the frames are kept
"""
import pathlib
import shutil
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import canopen_rules
import canopen_rules_test
import vm_bench
from vm_bench import BENCH, SCHEDULE, check, listening_to, send

NODES, FAULTY = (1, 2), 1
# By a stranger: 6007h of the faulty node is to be "fault", and then it is taken out of operational under power.
MAKE_IT_FAIL = ("601#2B07600001000000", "000#8001")


def run_twice(build, folder):
    pendant = vm_bench.Pendant()
    devices = vm_bench.Devices(build, BENCH, sys.stderr)

    def run(resume):
        return vm_bench.Campaign(build, SCHEDULE, BENCH, folder, devices, pendant, sys.stderr, resume)

    send("000#8100")
    campaign = run(False)
    check(devices.wait_until(safe=False, seconds=120), "the shafts turn")
    for frame in MAKE_IT_FAIL:
        send(frame)
    code = campaign.wait(60)
    check(code == 3, f"a drive has a fault: the program ends as after one ({code})")
    campaign = run(True)
    check(devices.wait_until(safe=False, seconds=30), "resumed: the shafts turn")
    pendant.press(vm_bench.QUICK_STOP)
    code = campaign.wait(60)
    check(code == 130, f"stopped by the pendant ({code})")
    devices.quit()


def main():
    scratch = pathlib.Path(tempfile.mkdtemp())
    log = scratch / "bus.log"
    vm_bench.into_memory("/usr/bin/candump", "/usr/bin/cansend")
    try:
        with listening_to(log):
            run_twice(pathlib.Path(sys.argv[1]), scratch / "campaign")
    finally:
        if len(sys.argv) > 2:
            shutil.copy(log, sys.argv[2])
    frames = canopen_rules.parse(log.read_text(encoding="utf-8").splitlines())
    check(len(frames) > 1000, f"candump heard {len(frames)} frames")
    check(canopen_rules.show(canopen_rules.judge(frames, NODES, [FAULTY])), "all rules hold")
    missed = canopen_rules_test.not_found(frames)
    check(not missed, f"each of them is found broken in frames that were changed {missed}")


if __name__ == "__main__":
    main()
