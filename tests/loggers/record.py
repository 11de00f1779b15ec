# SPDX-License-Identifier: Apache-2.0
"""A record on its way from the machine to the file, and what is true of the machine."""
import dataclasses

import numpy

SPEED_WORDS = r"speed|rpm|order|line"


@dataclasses.dataclass
class Truth:
    """A number of the machine; an answer may be off by four of its own stated errors + share * |value| + floor."""
    value: float
    share: float
    floor: float

    def room(self, stated_error):
        return 4.0 * stated_error + self.share * abs(self.value) + self.floor


@dataclasses.dataclass
class Record:
    kind: str
    metadata: dict  # key -> text
    columns: dict  # name -> array of numbers or list of words
    noise: dict  # name -> standard deviation, added when the record is measured
    decimals: dict  # name -> digits after the point in the file
    truth: dict  # quantity -> Truth, by the key of the program's JSON
    causes: dict  # cause that is there -> {parameter: Truth}
    angles: dict = dataclasses.field(default_factory=dict)  # column of a turning angle -> a turn in its unit
    shared_noise: float = 0.0  # correlation of the noise of all channels

    def rows(self):
        return len(next(iter(self.columns.values())))

    def channels(self):
        """Measured quantities: what is neither time nor a word."""
        return [name for name, values in self.columns.items() if name != "time_s" and not isinstance(values, list)]

    def keep(self, rows):
        """Rows by mask or by index, which may name one several times."""
        index = numpy.arange(self.rows())[rows]
        for name, values in self.columns.items():
            self.columns[name] = [values[k] for k in index] if isinstance(values, list) else values[index]

    def stay(self, row, count):
        """The machine stands for `count` samples in the state of `row`; the clock goes on."""
        index = numpy.concatenate([numpy.arange(row), numpy.full(count, row), numpy.arange(row, self.rows())])
        clock = self.columns.get("time_s")
        self.keep(index)
        if clock is not None:
            step_s = clock[1] - clock[0]
            late_s = numpy.concatenate([numpy.zeros(row), numpy.arange(count), numpy.full(len(clock) - row, count)]) * step_s
            self.columns["time_s"] = self.columns["time_s"] + late_s

    def measure(self, rng):
        common = rng.standard_normal(self.rows())
        for name, sd in self.noise.items():
            own = rng.standard_normal(self.rows())
            noise = numpy.sqrt(self.shared_noise) * common + numpy.sqrt(1.0 - self.shared_noise) * own
            self.columns[name] = self.columns[name] + sd * noise

    def text(self):
        words = [values if isinstance(values, list) else ["%.*f" % (self.decimals.get(name, 6), value) for value in values]
                 for name, values in self.columns.items()]
        lines = ["# %s: %s" % item for item in self.metadata.items()] + [",".join(self.columns)]
        return "\n".join(lines + [",".join(row) for row in zip(*words)]) + "\n"
