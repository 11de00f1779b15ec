#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Does the live page cost the control loop anything? A campaign in real time, its drives on Modbus TCP, with nobody who
looks on and with many viewers in turn: periods of the loop (1 ms or 10 ms) that began late, and processor time of the
page's process. On a quiet machine of at least two cores.

  tests/benchmarks/viewers_and_loop.py build [--viewers 50] [--seconds 60] [--turns 4]
"""
import argparse
import contextlib
import pathlib
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import threading
import time
import urllib.parse

TESTS = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "vm"), str(TESTS / "simulation")]
import soak_bench
import vm_bench

LONGEST_S = 120.0


def cpu_s(process):
    return sum(seconds for _, seconds in vm_bench.thread_times(process))


def viewer(host, port):
    """A connection to the page's stream of events, which is read until the page is gone."""
    stream = socket.create_connection((host, port))
    stream.sendall(f"GET /api/v1/events HTTP/1.1\r\nHost: {host}:{port}\r\n\r\n".encode())
    begin = stream.recv(1 << 16)
    assert begin.startswith(b"HTTP/1.1 200"), begin

    def read():
        with contextlib.suppress(OSError):
            while stream.recv(1 << 16):
                pass

    threading.Thread(target=read, daemon=True).start()
    return stream


def late_periods(options, folder, viewers):
    """(late periods, share of a core that the page takes)"""
    bench, schedule = folder / "bench.yaml", folder / "schedule.yaml"
    bench.write_text(soak_bench.bench_text("tcp"), encoding="utf-8")
    schedule.write_text(soak_bench.schedule_text("tcp", 1).replace("duration: 20 s", "duration: 30 min"), encoding="utf-8")
    with open(folder / "log.txt", "w", encoding="utf-8") as log:
        devices = vm_bench.Devices(options.build, bench, log)
        campaign = vm_bench.Campaign(options.build, schedule, bench, folder / "campaign", devices, None, log)
        vm_bench.wait_for_load(folder / "campaign", devices, f"{viewers} viewers")
        page = subprocess.Popen([str(options.build / "strainwave"), "serve", str(folder / "campaign"), "--port", "0"],
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        lines = vm_bench.Lines(page.stdout, log)
        said = lines.wait_for("http://", LONGEST_S)[1]
        address = urllib.parse.urlsplit(next(word for word in said.split() if word.startswith("http://")))
        streams = [viewer(address.hostname, address.port) for _ in range(viewers)]
        before = cpu_s(page)
        time.sleep(options.seconds)
        share = (cpu_s(page) - before) / options.seconds
        for stream in streams:
            stream.close()
        campaign.process.send_signal(signal.SIGINT)
        campaign.wait(LONGEST_S)
        page.terminate()
        page.wait(LONGEST_S)
        devices.quit()
    ((late,),) = vm_bench.from_journal(folder / "campaign", "SELECT value FROM campaign WHERE key = 'overruns_of_the_last_run'")
    return int(late), share


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=lambda path: pathlib.Path(path).resolve())
    parser.add_argument("--viewers", type=int, default=50)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--turns", type=int, default=4)
    options = parser.parse_args()
    late = {0: [], options.viewers: []}
    for turn in range(options.turns):
        for viewers in sorted(late, reverse=turn % 2 == 1):
            with tempfile.TemporaryDirectory() as folder:
                count, share = late_periods(options, pathlib.Path(folder), viewers)
            late[viewers].append(count)
            print(f"turn {turn + 1}, {viewers} viewers: {count} periods began late, the page took {100 * share:.1f} % of a core",
                  flush=True)
    for viewers, counts in late.items():
        print(f"{viewers} viewers: median {statistics.median(counts):g} late periods ({', '.join(map(str, counts))})")


if __name__ == "__main__":
    sys.exit(main())
