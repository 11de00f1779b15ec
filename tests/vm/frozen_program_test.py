#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Drives stop by themselves when the program is killed, or stopped as by a debugger, in a load run; a program that is
let go again ends with the bench safe, and its campaign goes on.

  tests/vm/frozen_program_test.py build tcp                        drives on Modbus TCP, here
  tests/vm/run.sh tests/vm/frozen_program_test.py build canopen    drives on vcan0
"""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "bench" / "peers"))
import soak_bench
import vm_bench
from free_port import free_port
from vm_bench import check

PATIENCE_S = 60.0


def with_free_ports(text):
    """Several of these tests may run on one machine."""
    for port in ("1502", "5025", "5026", "1510", "1511"):
        text = text.replace(f"127.0.0.1:{port}", f"127.0.0.1:{free_port()}")
    return text


def stopped_after_s(devices, process, number):
    """Since when the shafts are safe, and how long after the signal that was."""
    sent = time.monotonic()
    process.send_signal(number)
    check(devices.wait_until(safe=True, seconds=PATIENCE_S), f"{number.name}: the drives stop by themselves")
    since = devices.safe_since()
    return since, since - sent


def main():
    build, kind = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        bench, schedule, out = folder / "bench.yaml", folder / "schedule.yaml", folder / "campaign"
        bench.write_text(with_free_ports(soak_bench.bench_text(kind)), encoding="utf-8")
        schedule.write_text(soak_bench.schedule_text(kind, 3), encoding="utf-8")
        devices = vm_bench.Devices(build, bench, open(folder / "devices.txt", "w", encoding="utf-8"))
        log = open(folder / "run.txt", "w", encoding="utf-8")

        def begin(*, resume):
            campaign = vm_bench.Campaign(build, schedule, bench, out, devices, None, log, resume)
            vm_bench.wait_for_load(out, devices, "resumed" if resume else "begun")
            return campaign

        campaign = begin(resume=False)
        try:
            since, after_s = stopped_after_s(devices, campaign.process, signal.SIGSTOP)
            print(f"SIGSTOP: safe after {after_s:.3f} s")
            campaign.process.send_signal(signal.SIGCONT)
            code = campaign.wait(PATIENCE_S)
            check(code in (1, 3), f"let go again, the program ends with a fault: exit code {code}")
            check(devices.safe_since() == since, "and no shaft has been let go since")
            check(campaign.lines.wait_for("stopped: torque is off, brakes are on", 0) is not None, "it says so")

            campaign = begin(resume=True)
            _, after_s = stopped_after_s(devices, campaign.process, signal.SIGKILL)
            print(f"SIGKILL: safe after {after_s:.3f} s")
            campaign.wait(PATIENCE_S)

            campaign = begin(resume=True)
            campaign.process.send_signal(signal.SIGINT)
            check(campaign.wait(PATIENCE_S) == 130, "it goes on after both")
            done = subprocess.run([build / "strainwave", "verify", out], check=False, stdout=subprocess.DEVNULL)
            check(done.returncode == 0, "and is whole")
        finally:
            if campaign.process.poll() is None:
                campaign.process.kill()
            devices.quit()


if __name__ == "__main__":
    main()
