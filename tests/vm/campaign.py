#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a campaign over vcan0, Modbus TCP, TCP streams and a uhid pendant against strainwave-devices, where these are
(in the virtual machine: tests/vm/run.sh), and copies its folder out.

  tests/vm/run.sh --write D tests/vm/campaign.py build schedules/quick.yaml D --minutes 40

D/run.txt says how far it is; with a file D/finish the cycle under way is the last one. Exit code: that of `strainwave run`.
"""
import argparse
import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import vm_bench

HERE = pathlib.Path(__file__).resolve().parent


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=pathlib.Path, help="folder with strainwave and strainwave-devices")
    parser.add_argument("schedule", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path, help="gets campaign/ and what the programs said")
    parser.add_argument("--bench", type=pathlib.Path, default=HERE / "campaign" / "bench.yaml")
    parser.add_argument("--minutes", type=float, default=40.0, help="of this machine's time; then the cycle under way is the last one")
    parser.add_argument("--cpu", action="store_true", help="print the CPU time of every thread at the end")
    options = parser.parse_args()
    options.out.mkdir(exist_ok=True)

    # SQLite finds no locks on a folder shared with the host.
    here = pathlib.Path(tempfile.mkdtemp()) / "campaign"
    pendant = vm_bench.Pendant()
    with open(options.out / "devices.txt", "w", encoding="utf-8") as said_by_devices, \
            open(options.out / "run.txt", "w", encoding="utf-8") as said_by_run:
        devices = vm_bench.Devices(options.build, options.bench, said_by_devices)
        campaign = vm_bench.Campaign(options.build, options.schedule, options.bench, here, devices, pendant, said_by_run)
        finish = vm_bench.time.monotonic() + 60 * options.minutes
        code = campaign.wait(5)
        while code is None and vm_bench.time.monotonic() < finish and not (options.out / "finish").exists():
            code = campaign.wait(5)
        if code is None:
            if options.cpu:
                for name, process in (("strainwave", campaign.process), ("strainwave-devices", devices.process)):
                    for thread, seconds in vm_bench.thread_times(process):
                        print(f"{name} {thread}: {seconds:.2f} s")
            subprocess.run([options.build / "strainwave", "stop", here, "finish-cycle"], check=False)
            code = campaign.wait(3600)
        devices.quit()
    if here.exists():
        shutil.copytree(here, options.out / "campaign", dirs_exist_ok=True)
    print((options.out / "run.txt").read_text(encoding="utf-8"))
    return 125 if code is None else code


if __name__ == "__main__":
    sys.exit(main())
