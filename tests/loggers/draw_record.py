# SPDX-License-Identifier: Apache-2.0
"""A case from (seed, number): a machine, what was done to its record, and the record."""
import dataclasses

import numpy

from labels import LABELS
from machines import MACHINES
from samples import MACHINE_STANDS, SAMPLES

CLEAN = 10000  # cases from here on are left as they are
HABITS = list(MACHINE_STANDS) + list(SAMPLES) + list(LABELS)


@dataclasses.dataclass
class Case:
    record: object
    done: list


def draw(seed, number, kind=None, habits=None):
    """The same (seed, number, kind, habits) gives the same record, whatever else is drawn."""
    rng = numpy.random.default_rng([seed, number])
    kinds = sorted(MACHINES)
    kind = kind or (kinds[number % len(kinds)] if number >= CLEAN else str(rng.choice(kinds)))
    record, done = MACHINES[kind](rng), []
    wanted = 0 if number >= CLEAN else int(rng.choice([1, 2, 3], p=[0.4, 0.4, 0.2]))
    # In the order in which things happen: to the machine, to its samples, to the labels of its file.
    tried = [str(name) for name in rng.permutation(habits or HABITS)]
    for stage in (MACHINE_STANDS, SAMPLES, LABELS):
        if stage is SAMPLES:
            record.measure(rng)
        for name in [name for name in tried[:wanted + 3] if name in stage]:
            words = stage[name](record, rng) if len(done) < wanted else None
            if words:
                done.append(words)
    return Case(record, done)
