#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What users reported, once more: a row a command (`rows.py`). Exit code 77: skipped, there are no reports.

usage: reports_test.py PROGRAM [REPORT|--some]      such as 05-wrapped-angle; --some: the last row of each report and
command, which has the fault that was reported and no control; all rows without either
"""
import concurrent.futures
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile

from outcome import Answer
from rows import ROWS

CHECKOUT = pathlib.Path(__file__).resolve().parents[2]
REPORTS = pathlib.Path(os.environ.get("STRAINWAVE_REPORTS") or CHECKOUT.parent / "shared" / "reports")


def make_inputs(report, folder):
    """By the report's own script where it has one."""
    folder.mkdir()
    script = next((path for path in (REPORTS / report).glob("make.*")), None)
    if script and script.suffix == ".py":
        subprocess.run(["/usr/bin/python3", "-B", str(script), str(folder)], check=True)
    elif script:
        subprocess.run(["bash", str(script), str(CHECKOUT), str(folder)], check=True)
    if report == "06-eds-of-makers":
        without_object(folder, "605D")
    elif report in ("13-time-stamps", "14-rate-contradiction"):
        noise = random.Random(2)
        for record in (REPORTS / report).glob("*.csv"):
            text = record.read_text(encoding="utf-8")
            records_of_two_classes(folder / record.stem, lambda loudness: with_noise(text, 0.1 * loudness, noise))
    elif report == "16-sparkplug-old-host":
        noise = random.Random(1)
        head = "# kind: vibration\n# sample_rate_hz: 12800\naccel_x_m_per_s2\n"
        records_of_two_classes(folder / "loud", lambda loudness: head + "".join(
            "%.5f\n" % noise.gauss(0.0, loudness) for _ in range(12800)))


def with_noise(text, sd, noise):
    """The record with noise on its last column; stamps and metadata stay."""
    lines = []
    for line in text.splitlines():
        stamp, _, value = line.rpartition(",")
        number = stamp[:1].isdigit()
        lines.append("%s,%.4f" % (stamp, float(value) + noise.gauss(0.0, sd)) if number else line)
    return "\n".join(lines) + "\n"


def records_of_two_classes(folder, text):
    folder.mkdir()
    for k in range(24):
        label = "# class: %s\n# specimen: s%d\n" % ("worn" if k % 2 else "ok", k)
        (folder / ("r%d.csv" % k)).write_text(label + text(4.0 if k % 2 else 1.0), encoding="utf-8")


def without_object(folder, index):
    """A data sheet that lacks what the profile touches."""
    variant = folder / ("without_" + index)
    subprocess.run(["cp", "-r", str(folder / "m_control"), str(variant)], check=True)
    sheet, keep, kept = variant / "drive.eds", True, []
    for line in sheet.read_text(encoding="latin-1").splitlines():
        keep = not line.upper().startswith("[" + index) if line.startswith("[") else keep
        if keep and not line.upper().endswith("=0X" + index):
            kept.append(line)
    sheet.write_text("\n".join(kept) + "\n", encoding="latin-1")


def run(program, row, made):
    places = {"{program}": program, "{reports}": str(REPORTS), "{made}": str(made)}
    command = [re.sub("|".join(places), lambda found: places[found.group()], part) for part in row.command]
    done = subprocess.run(command if command[0] == "bash" else [program, *command], stdin=subprocess.DEVNULL, capture_output=True, timeout=300, check=False)
    return Answer(done.returncode, done.stdout.decode("utf-8", "replace"), done.stderr.decode("utf-8", "replace"))


def some_of(rows):
    """The last row of each report and command: controls come first."""
    return list({(row.report, row.command[0]): row for row in rows}.values())


def main():
    program = sys.argv[1]
    wanted = sys.argv[2] if len(sys.argv) > 2 else None
    rows = some_of(ROWS) if wanted == "--some" else [row for row in ROWS if wanted in (None, row.report)]
    if not REPORTS.is_dir():
        print("skipped, because there are no reports (STRAINWAVE_REPORTS, or ../shared/reports)")
        return 77
    failed = 0
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(2) as pool:
        made = pathlib.Path(folder)
        for report in sorted({row.report for row in rows}):
            make_inputs(report, made / report)
        for row, answer in zip(rows, pool.map(lambda row: run(program, row, made), rows)):
            objections = row.objections(answer)
            failed += bool(objections)
            print("%-6s %s" % ("FAILED" if objections else "ok", " ".join(row.command).replace("{reports}/", "").replace("{made}/", "")))
            for objection in objections:
                print("       " + objection)
    print("%d of %d rows are as expected" % (len(rows) - failed, len(rows)))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
