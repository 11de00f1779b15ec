#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What kill_and_resume.py reads from a campaign's journal; all SQL of that test is here."""
import contextlib
import dataclasses
import shutil
import sqlite3
import tempfile


@dataclasses.dataclass(frozen=True)
class Journal:
    """A journal as it stood at one moment."""
    cycles: dict      # cycle -> outcome
    steps: dict       # cycle -> sorted (step, repeat) of its complete phases
    credited_s: dict  # (cycle, step) -> load time, all attempts together
    loads: list       # (id, duration by the bench's clock, credited load time) of each ended phase under load
    results: dict     # (cycle, repeat, quantity) -> (value, standard error, flag)
    phases: list      # (id, cycle, step, kind, started_s, ended_s, outcome) by id
    event_ids: list
    holes: int

    @property
    def running_load(self):
        """(cycle, step) of the load run that the kill cut, or None."""
        _, cycle, step, kind, *_, outcome = self.phases[-1] if self.phases else (None,) * 7
        return (cycle, step) if (kind, outcome) == ("load_run", "running") else None

    @property
    def complete(self):
        return {cycle for cycle, outcome in self.cycles.items() if outcome == "complete"}


def open_copy(path, copies):
    """Opens a copy: opening the journal itself would recover it, which is the work of the program under test."""
    for suffix in ("", "-wal"):
        file = path.with_name(path.name + suffix)
        if file.exists():
            shutil.copy(file, copies)
    return sqlite3.connect(f"{copies}/{path.name}")


def read(folder):
    """The journal of a campaign that nobody runs; None before it has one."""
    path = folder / "campaign.db"
    if not path.exists():
        return None
    with tempfile.TemporaryDirectory() as copies, contextlib.closing(open_copy(path, copies)) as database:
        if database.execute("PRAGMA integrity_check").fetchone() != ("ok",):
            raise AssertionError(f"{path}: damaged")
        rows = database.execute
        steps = {}
        for cycle, step, repeat in rows("SELECT cycle, step, repeat FROM phases WHERE outcome = 'complete'"
                                        " ORDER BY cycle, step, repeat"):
            steps.setdefault(cycle, []).append((step, repeat))
        return Journal(
            cycles=dict(rows("SELECT cycle, outcome FROM cycles ORDER BY cycle")),
            steps=steps,
            credited_s={(cycle, step): seconds for cycle, step, seconds in rows(
                "SELECT cycle, step, SUM(credited_load_s) FROM phases GROUP BY cycle, step")},
            loads=list(rows("SELECT id, ended_s - started_s, credited_load_s FROM phases"
                            " WHERE kind = 'load_run' AND outcome <> 'running'")),
            results={(cycle, repeat, quantity): numbers for cycle, repeat, quantity, *numbers in rows(
                "SELECT cycle, repeat, quantity, value, standard_error, flag FROM results")},
            phases=list(rows("SELECT id, cycle, step, kind, started_s, ended_s, outcome FROM phases ORDER BY id")),
            event_ids=[number for (number,) in rows("SELECT id FROM events ORDER BY id")],
            holes=rows("SELECT COUNT(*) FROM holes").fetchone()[0])
