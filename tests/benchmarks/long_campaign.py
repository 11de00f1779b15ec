#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""How long `status` and `table` take, and `run --resume` until it works, on a campaign of very many cycles; memory of
all three.

  tests/benchmarks/long_campaign.py --program build/strainwave [--other OTHER/build/strainwave] [--cycles 100000]
  tests/benchmarks/long_campaign.py --program build/strainwave --than 1000     beside a campaign of so many cycles

Each program makes a small campaign of its own, which is then filled: rows of its last cycle again and again, through
SQLite, in the tables that the program has made. Both are timed in turn. --make FOLDER only makes the campaign.
"""
import argparse
import contextlib
import json
import os
import pathlib
import signal
import sqlite3
import statistics
import struct
import subprocess
import sys
import tempfile
import time
import zlib

SMALL = pathlib.Path(__file__).resolve().parents[1] / "simulation" / "small.yaml"
PAGE_BYTES, CHECKSUM_BYTES = 4096, 8
TEMPLATE_CYCLES = 3


def seal(path):
    """Checksums in every page, as bench/campaign/page_checksums.h says; nothing where there is no room for them."""
    with open(path, "r+b") as file:
        if file.read(100)[20] != CHECKSUM_BYTES:
            return
        for number in range(1, path.stat().st_size // PAGE_BYTES + 1):
            file.seek((number - 1) * PAGE_BYTES)
            content = file.read(PAGE_BYTES - CHECKSUM_BYTES)
            crc = zlib.crc32(content, zlib.crc32(struct.pack("<I", number)))
            file.seek(number * PAGE_BYTES - CHECKSUM_BYTES)
            file.write(struct.pack("<II", crc, crc ^ 0xFFFFFFFF))


def columns(journal, table):
    return [row[1] for row in journal.execute(f"PRAGMA table_info({table})")]


def fill(journal, cycles):
    """Repeats the last complete cycle, with all that belongs to it, until there are so many."""
    (last,) = journal.execute("SELECT MAX(cycle) FROM cycles WHERE outcome = 'complete'").fetchone()
    (period_s,) = journal.execute("SELECT ended_s - started_s FROM cycles WHERE cycle = ?", (last,)).fetchone()
    for table in "phases", "results", "cycles":
        journal.execute(f"DELETE FROM {table} WHERE cycle > ?", (last,))
    journal.execute("CREATE TEMP TABLE more(n INTEGER PRIMARY KEY)")
    journal.executemany("INSERT INTO more VALUES(?)", ((n,) for n in range(1, cycles - last + 1)))
    for table in "cycles", "phases", "results", "events":
        names = [name for name in columns(journal, table) if name != "id"]
        copied = [{"cycle": "cycle + n", "started_s": f"started_s + n * {period_s}", "ended_s": f"ended_s + n * {period_s}",
                   "value": "value * (1 - 1e-7 * n)"}.get(name, name) for name in names]
        # One word in a thousand cycles is much for a campaign that runs well.
        seldom = "AND n % 1000 = 0" if table == "events" else ""
        source = f"{table} WHERE cycle = {last}" if table != "events" else "events WHERE id = (SELECT MIN(id) FROM events)"
        journal.execute(f"INSERT INTO {table}({', '.join(names)}) SELECT {', '.join(copied)} FROM more CROSS JOIN "
                        f"(SELECT * FROM {source}) WHERE 1 {seldom} ORDER BY n")


def keep_totals(journal):
    """Sums of samples up to the last cycle, as bench/campaign/sample_totals.h says; nothing where none are kept."""
    if not journal.execute("SELECT 1 FROM campaign WHERE key = 'sample_totals'").fetchone():
        return
    sums = journal.execute("SELECT quantity, SUM(value) FROM results WHERE quantity LIKE 'samples_%' AND repeat = 0 "
                           "GROUP BY quantity").fetchall()
    (last,) = journal.execute("SELECT MAX(cycle) FROM cycles").fetchone()
    totals = {"last_cycle": last}
    for kind in "received", "lost":
        begin = f"samples_{kind}_"
        totals[kind] = {name.removeprefix(begin): total for name, total in sums if name.startswith(begin)}
    journal.execute("UPDATE campaign SET value = ? WHERE key = 'sample_totals'", (json.dumps(totals),))


def make(program, folder, cycles):
    schedule = folder.with_suffix(".yaml")
    text = SMALL.read_text().replace("cycles: 3", f"cycles: {2 * cycles}").replace("duration: 20 min", "duration: 1 min")
    schedule.write_text(text)
    process = subprocess.Popen([program, "run", schedule, "--out", folder], stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
    while not (folder / "cycles" / f"{TEMPLATE_CYCLES:06d}.h5").exists():
        time.sleep(0.01)
    process.send_signal(signal.SIGUSR2)  # finishes the cycle
    process.wait()
    with contextlib.closing(sqlite3.connect(folder / "campaign.db")) as journal:
        journal.execute("PRAGMA synchronous = OFF")
        with journal:
            fill(journal, cycles)
            keep_totals(journal)
        journal.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    seal(folder / "campaign.db")
    return schedule


def ended(process):
    """Peak memory in MB, when the process has ended."""
    _, _, usage = os.wait4(process.pid, 0)
    return usage.ru_maxrss / 1024


def time_command(*command):
    began = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    memory_MB = ended(process)
    return time.monotonic() - began, memory_MB


def time_status(program, folder, _):
    return time_command(program, "status", folder)


def time_table(program, folder, _):
    return time_command(program, "table", folder, "--out", folder.with_suffix(".csv"))


def time_resume(program, folder, schedule):
    """Until the first checkpoint of a phase is written."""
    before = (folder / "checkpoint").stat().st_mtime_ns
    began = time.monotonic()
    process = subprocess.Popen([program, "run", schedule, "--out", folder, "--resume", "--accept-pause"],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while (folder / "checkpoint").stat().st_mtime_ns == before:
        time.sleep(0.001)
    took_s = time.monotonic() - began
    with open(f"/proc/{process.pid}/status", encoding="ascii") as status:
        memory_MB = next(int(line.split()[1]) for line in status if line.startswith("VmHWM")) / 1024
    process.kill()  # what it prints at the end is not measured
    ended(process)
    return took_s, memory_MB


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, type=lambda path: pathlib.Path(path).resolve())
    parser.add_argument("--other", type=lambda path: pathlib.Path(path).resolve())
    parser.add_argument("--cycles", type=int, default=100000)
    parser.add_argument("--than", type=int, help="cycles of a second campaign of the same program")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--make", type=lambda path: pathlib.Path(path).resolve())
    options = parser.parse_args()
    if options.make:
        make(options.program, options.make, options.cycles)
        return
    with tempfile.TemporaryDirectory() as scratch:
        cases = [(options.program, options.cycles)]
        if options.other:
            cases.append((options.other, options.cycles))
        if options.than:
            cases.append((options.program, options.than))
        folders = [pathlib.Path(scratch) / f"campaign_{number}" for number in range(len(cases))]
        schedules = [make(program, folder, cycles) for (program, cycles), folder in zip(cases, folders)]
        for name, measure in ("status", time_status), ("table", time_table), ("resume", time_resume):
            seen = [[] for _ in cases]
            for run in range(options.runs + 1):
                for number, ((program, _), folder, schedule) in enumerate(zip(cases, folders, schedules)):
                    measured = measure(program, folder, schedule)
                    if run > 0:  # the first is a warm-up
                        seen[number].append(measured)
            medians = [statistics.median(took_s for took_s, _ in one) for one in seen]
            for (program, cycles), one, median in zip(cases, seen, medians):
                times = " ".join(f"{took_s:.3f}" for took_s, _ in one)
                print(f"{name}  median {median:.3f} s  peak {max(m for _, m in one):.0f} MB  ({times})  {cycles} cycles  "
                      f"{program}")
            for (program, cycles), median in list(zip(cases, medians))[1:]:
                print(f"{name}  {medians[0] / median:.4f} of the time of {cycles} cycles, {program}")


if __name__ == "__main__":
    sys.exit(main())
