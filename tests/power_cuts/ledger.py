# SPDX-License-Identifier: Apache-2.0
"""What a campaign has kept and said, written down outside of it, and held against what is left of it after a cut."""
import hashlib
import json
import pathlib
import struct
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "simulation"))
import campaign_journal  # noqa: E402

CHECKPOINT_SLOT_BYTES = 16384
CHECKPOINT_HEADER = struct.Struct("<8sQ")


class Lost(Exception):
    """The campaign is not what it must be; the text says where."""


def expect(holds, text):
    if not holds:
        raise Lost(text)


def seal_of(folder, journal, cycle):
    """Of a cycle that is complete, all that must never change."""
    file = folder / "cycles" / f"{cycle:06d}.h5"
    expect(file.exists(), f"cycle {cycle} is complete, but {file.name} is missing")
    return (hashlib.sha256(file.read_bytes()).hexdigest(),
            {key: numbers for key, numbers in journal.results.items() if key[0] == cycle})


def newest_state(folder):
    """The number of the newest state in a checkpoint, whole or not; 0 where there is none."""
    file = folder / "checkpoint"
    if not file.exists():
        return 0
    text = file.read_bytes()
    heads = [text[at:at + CHECKPOINT_HEADER.size] for at in range(0, len(text), CHECKPOINT_SLOT_BYTES)]
    return max(number for magic, number in map(CHECKPOINT_HEADER.unpack, heads) if magic in (b"swcheck1", bytes(8)))


class Ledger:
    def __init__(self, program):
        self.program = program
        self.sealed = {}  # cycle -> its seal, since the program went on from it
        self.ended = set()  # (cycle, step, repeat) of phases, likewise
        self.state = 0  # of the checkpoint, the newest that was synced

    def note(self, disk):
        """What the program had seen as kept, and gone on from, when the power went."""
        for side in ("seen", "synced"):
            folder = disk.side(side)
            journal = campaign_journal.read(folder)
            if journal is None:
                continue
            newest = max(journal.cycles, default=-1)
            for cycle in journal.complete:
                # In what is seen the newest row may be one that the program still waits for.
                gone_on = side == "synced" or cycle < newest or not any(
                    (folder / "unfinished").glob(f"{cycle:06d}-*.h5"))
                if gone_on:
                    seal = seal_of(folder, journal, cycle)
                    expect(self.sealed.setdefault(cycle, seal) == seal, f"cycle {cycle} changed in what the program saw")
            complete = [(cycle, step, repeat) for cycle, steps in journal.steps.items() for step, repeat in steps]
            last = journal.phases[-1][1:3] if journal.phases else None
            self.ended |= {phase for phase in complete if side == "synced" or phase[:2] != last}
        self.state = max(self.state, newest_state(disk.side("synced")))

    def compare(self, disk, recomputes=False):
        """What is left, with what was noted."""
        folder = disk.side("disk")
        journal = campaign_journal.read(folder)
        if journal is None:
            expect(not self.sealed and not self.ended, "the journal is gone")
            return
        for cycle, seal in self.sealed.items():
            expect(cycle in journal.complete, f"cycle {cycle} was complete, and is no more")
            expect(seal_of(folder, journal, cycle) == seal, f"cycle {cycle} changed after it was complete")
        complete = {(cycle, step, repeat) for cycle, steps in journal.steps.items() for step, repeat in steps}
        expect(self.ended <= complete, f"phases {self.ended - complete} had ended, and have not any more")
        expect(newest_state(folder) >= self.state, "a state of the checkpoint that was synced is gone")
        self.read("status", folder)
        if recomputes and journal.complete:
            whole = self.read("recompute", folder)
            expect(not whole["cycles_differing"], f"recompute gives something else than stored: {whole['cycles_differing']}")

    def read(self, command, folder):
        done = subprocess.run([self.program, command, folder, "--json"], capture_output=True, text=True, check=False)
        expect(done.returncode == 0, f"{command} ended with {done.returncode}: {done.stderr}")
        return json.loads(done.stdout)
