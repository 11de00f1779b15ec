# SPDX-License-Identifier: Apache-2.0
"""Makes the table of docs/bench/faults.md of what field_faults_test has printed with STRAINWAVE_FAULT_MATRIX=1.

usage: fault_matrix_table.py FILE   exit code 1, and no table, when a test failed or a cell is missing
"""
import re
import sys

CELL = re.compile(r"^cell (\d+) (\d+) \| (.+?) \| (\w+) \| (\S+) \| (\S+) \| (.*)$", re.MULTILINE)


def main() -> int:
    with open(sys.argv[1], encoding="utf-8") as file:
        text = file.read()
    faults, phases, cells = {}, {}, {}
    for fault, phase, name, phase_name, after_ms, stated_ms, words in CELL.findall(text):
        faults[int(fault)] = name
        phases[int(phase)] = phase_name.replace("_", " ")
        cells[int(fault), int(phase)] = after_ms, stated_ms, words
    missing = [f"{faults[f]} during {phases[p]}" for f in faults for p in phases if (f, p) not in cells]
    if "[  FAILED  ]" in text or missing or not cells:
        print("fault_matrix_table.py: error: tests that failed, or cells that are missing:", *missing, sep="\n  ",
              file=sys.stderr)
        return 1
    print("| fault |", *(f"{phases[p]} |" for p in sorted(phases)), "stated | in words |")
    print("|" + " --- |" * (len(phases) + 3))
    for f in sorted(faults):
        row = [cells[f, p] for p in sorted(phases)]
        stated = sorted({int(stated_ms) for _, stated_ms, _ in row if stated_ms != "–"})
        span = "–" if not stated else f"{stated[0]}–{stated[-1]}" if len(stated) > 1 else f"{stated[0]}"
        print(f"| {faults[f]} |", *(f"{after_ms} |" for after_ms, _, _ in row), f"{span} | {row[0][2]} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
