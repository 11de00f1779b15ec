# SPDX-License-Identifier: Apache-2.0
"""The further generators by name, each with its role, which is a part of what the name means and never changes.

`tuning`: cases may be looked at when the program is improved. `figures only`: nobody looks at single cases, the summary lists none.
"""
import dataclasses
import typing

from . import axes, gears, loops, vibration

TUNING, FIGURES_ONLY = "tuning", "figures only"
ROLE_WORDS = {"tuning": TUNING, "figures_only": FIGURES_ONLY}


@dataclasses.dataclass(frozen=True)
class Generator:
    name: str
    model: typing.Callable
    role: str
    what: str

    @property
    def kind(self):
        return self.model.kind


GENERATORS = {generator.name: generator for generator in (
    Generator("stepped_gear", gears.SteppedGear, TUNING, "steps and settles; relaxing torque levels"),
    Generator("running_gear", gears.RunningGear, FIGURES_ONLY, "sampled on the run by a clock that jitters"),
    Generator("staircase_loop", loops.StaircaseLoop, TUNING, "stairs of torque with holds, by the return mapping"),
    Generator("servo_loop", loops.ServoLoop, FIGURES_ONLY, "a load servo with an inertia, under PI control of the torque"),
    Generator("lugre_cascade_axis", axes.LugreCascade, TUNING, "LuGre friction, P-PI cascade, Runge-Kutta"),
    Generator("slip_feedforward_axis", axes.SlipFeedforward, FIGURES_ONLY, "generalised Maxwell slip, cascade with friction fed forward"),
    Generator("dahl_dither_axis", axes.DahlDither, TUNING, "Dahl friction, PID with dither, filtered trace"),
    Generator("bouc_wen_observer_axis", axes.BoucWenObserver, FIGURES_ONLY, "Bouc-Wen friction, disturbance observer, held means"),
    Generator("modal_vibration", vibration.ModalVibration, TUNING, "modes of a housing, speed steady or in two levels"),
    Generator("run_up_vibration", vibration.RunUpVibration, FIGURES_ONLY, "late, low-passed and echoed paths, a run-up or coast-down"))}


def named(words):
    """Generators for a list such as `tuning,servo_loop`; KeyError with the word that is none."""
    found = {}
    for word in words.split(","):
        role = ROLE_WORDS.get(word)
        for generator in [g for g in GENERATORS.values() if g.role == role] if role else [GENERATORS[word]]:
            found[generator.name] = generator
    return list(found.values())


def table():
    return "\n".join("%-24s %-20s %-14s %s" % (g.name, g.kind, g.role, g.what) for g in GENERATORS.values())
