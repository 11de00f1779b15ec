# SPDX-License-Identifier: Apache-2.0
"""One command on one file, and the ways in which it may come out."""
import dataclasses
import json
import math
import re


@dataclasses.dataclass
class Answer:
    code: int
    output: str
    errors: str

    def words(self):
        return self.output + "\n" + self.errors

    def number(self, path):
        """`a.b.0.c` in the JSON; None where it is null or not there."""
        here = json.loads(self.output)
        for part in path.split("."):
            if isinstance(here, list):
                here = here[int(part)] if int(part) < len(here) else None
            elif isinstance(here, dict):
                here = here.get(part)
            else:
                return None
        return here


@dataclasses.dataclass
class Near:
    value: float
    room: float

    def holds(self, found):
        return isinstance(found, (int, float)) and math.isfinite(found) and abs(found - self.value) <= self.room

    def __str__(self):
        return "%g within %g" % (self.value, self.room)


def share(value, part):
    return Near(value, part * value)


@dataclasses.dataclass
class Outcome:
    """All of it holds: exit code, numbers by path, texts by path, and words somewhere in the output (regular expressions)."""
    codes: tuple
    numbers: dict = dataclasses.field(default_factory=dict)
    texts: dict = dataclasses.field(default_factory=dict)
    words: tuple = ()
    also: object = None  # a function of the answer that returns what is wrong with it, or nothing

    def objections(self, answer):
        if answer.code not in self.codes:
            return ["exit code %d (expected %s)" % (answer.code, " or ".join(map(str, self.codes)))]
        found = ["says nothing like '%s'" % word for word in self.words if not re.search(word, answer.words())]
        try:
            for path, near in self.numbers.items():
                if not near.holds(answer.number(path)):
                    found.append("%s is %s (expected %s)" % (path, answer.number(path), near))
            for path, text in self.texts.items():
                if answer.number(path) != text:
                    found.append("%s is %s (expected %s)" % (path, answer.number(path), text))
            wrong = self.also(answer) if self.also else None
        except ValueError as reason:
            wrong = "no JSON: %s" % reason
        return found + ([wrong] if wrong else [])


@dataclasses.dataclass
class Row:
    report: str
    command: tuple  # of the program, or bash -c ...; {reports} and {made} are the folders of what is there and of what was made
    outcomes: tuple  # one of them has to hold
    never: tuple = ()  # words that must not be said

    def objections(self, answer):
        said = ["says '%s'" % word for word in self.never if re.search(word, answer.words())]
        if answer.code < 0:
            said.append("ended by signal %d" % -answer.code)
        each = [outcome.objections(answer) for outcome in self.outcomes]
        if all(each):
            said += [" / ".join(", ".join(objections) for objections in each)]
        return said
