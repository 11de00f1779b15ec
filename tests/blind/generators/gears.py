# SPDX-License-Identifier: Apache-2.0
"""Two benches for transmission error: one that steps and settles, one that samples on the run."""
import math

import numpy

from .gear import Gear


def _wave(rng, share, most):
    """A sum of three slow sines with a random walk's spectrum."""
    return sum(most / k * numpy.sin(2.0 * math.pi * (k * rng.uniform(0.8, 1.4) * share + rng.random())) for k in (1, 2, 3)) / 1.8


class SteppedGear(Gear):
    """Steps of the output; between them the drive settles with a damped oscillation, of which the sample still has a trace in both
    encoders. Torque: levels that relax, as a brake holds them. Temperature: first order, with the room's slow sines."""

    def draw_bench(self, rng, wants):
        # A step that is a whole turn of an order would leave that order out of the record.
        spacings_deg = [step for step in (0.5, 0.8, 1.0, 1.5) if all(
            abs((order * self.ratio * step + 180.0) % 360.0 - 180.0) > 15.0 for order in (1.0, 2.0, 4.0))]
        self.spacing_deg = float(rng.choice(spacings_deg))
        both = "backlash" in wants or rng.random() < 0.8
        turns = int(rng.choice([1, 2], p=[0.7, 0.3]))
        steps = int(360.0 * turns / self.spacing_deg)
        there = self.spacing_deg * numpy.arange(steps)
        self.target_deg = numpy.concatenate([there, there[::-1]]) if both else there
        self.sense = numpy.where(numpy.arange(len(self.target_deg)) < steps, 1.0, -1.0)
        count = len(self.target_deg)
        dwell_s = rng.uniform(0.4, 1.2)
        self.time_s = numpy.cumsum(dwell_s * (1.0 + 0.08 * rng.standard_normal(count)).clip(0.6, 1.4))
        left = rng.uniform(0.01, 0.1) * numpy.exp(-rng.exponential(1.0, count)) * numpy.sin(rng.uniform(0.0, 6.28, count))
        self.input_deg = self.ratio * self.target_deg + math.copysign(1.0, self.ratio) * (left * 10.0 - 0.3 * self.sense)
        share = self.time_s / self.time_s[-1]
        torque = numpy.zeros(count)
        for at in numpy.sort(rng.uniform(0.0, 1.0, int(rng.integers(4, 9)))):
            since = (share - at).clip(0.0)
            torque += (share >= at) * rng.uniform(-9.0, 9.0) * (0.6 + 0.4 * numpy.exp(-since / 0.05))
        self.torque_Nm = torque + _wave(rng, share, 1.0)
        self.temperature_degC = 20.0 + rng.uniform(-2.0, 6.0) + rng.uniform(2.0, 7.0) * (1.0 - numpy.exp(-share / rng.uniform(0.2, 0.7))) + \
            _wave(rng, share, 0.4)
        drift = "thermal_drift" in wants
        self.has_temperature = rng.random() < (0.5 if drift else 0.3)
        self.has_time = (drift and not self.has_temperature) or rng.random() < 0.8
        self.has_torque = "load_windup" in wants or rng.random() < 0.4


class RunningGear(Gear):
    """On the run: a trapezoid of speed with a ripple, sampled by a clock that jitters, so that no two samples are equally far apart.
    Torque: of a load motor, ramps and waves. Temperature: a power of time."""

    def draw_bench(self, rng, wants):
        both = "backlash" in wants or rng.random() < 0.8
        turns = int(rng.choice([1, 2], p=[0.6, 0.4]))
        rate_hz, per_turn = rng.uniform(20.0, 60.0), rng.uniform(700.0, 1400.0)
        count = int(turns * per_turn)
        shape = numpy.minimum(1.0, numpy.minimum(numpy.arange(count) + 1.0, count - numpy.arange(count)) / (0.03 * count))
        speed = shape * (1.0 + 0.05 * numpy.sin(2.0 * math.pi * (rng.uniform(2.0, 5.0) * numpy.arange(count) / count + rng.random())))
        there = numpy.cumsum(speed)
        there = (there - there[0]) / (there[-1] - there[0]) * 360.0 * turns
        self.target_deg = numpy.concatenate([there, there[::-1]]) if both else there
        self.sense = numpy.where(numpy.arange(len(self.target_deg)) < count, 1.0, -1.0)
        count = len(self.target_deg)
        self.spacing_deg = 360.0 / per_turn
        self.time_s = (numpy.arange(count) + 0.05 * rng.random(count)) / rate_hz + (self.sense < 0) * rng.uniform(1.0, 4.0)
        self.input_deg = self.ratio * self.target_deg + rng.normal(0.0, 0.02, count)
        share = self.time_s / self.time_s[-1]
        ramp = numpy.interp(share, numpy.sort(rng.random(6)), rng.uniform(-10.0, 10.0, 6))
        self.torque_Nm = ramp + _wave(rng, share, 3.0)
        self.temperature_degC = rng.uniform(18.0, 27.0) + rng.uniform(1.0, 5.0) * share ** rng.uniform(0.5, 1.0) + _wave(rng, share, 0.3)
        self.has_temperature = rng.random() < (0.5 if "thermal_drift" in wants else 0.3)
        self.has_time, self.has_torque = True, "load_windup" in wants or rng.random() < 0.5
