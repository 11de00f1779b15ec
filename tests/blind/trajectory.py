# SPDX-License-Identifier: Apache-2.0
"""Prescribed motions as closed formulae: position, speed and acceleration are exact at any time, also between samples."""
import math

import numpy


class MultiSine:
    """A few sines of unrelated frequencies; with one it is a plain sine test."""

    def __init__(self, rng, tones, lowest_hz, highest_hz, travel):
        self.frequency_hz = numpy.sort(numpy.exp(rng.uniform(math.log(lowest_hz), math.log(highest_hz), tones)))
        weight = rng.uniform(0.5, 1.0, tones) / (self.frequency_hz / self.frequency_hz[0]) ** 0.8
        self.amplitude = travel * weight / weight.sum()
        self.phase = rng.uniform(-math.pi, math.pi, tones)
        self.highest_hz = float(self.frequency_hz[-1])

    def at(self, time_s):
        omega = 2.0 * math.pi * self.frequency_hz[:, numpy.newaxis]
        angle = omega * time_s + self.phase[:, numpy.newaxis]
        amplitude = self.amplitude[:, numpy.newaxis]
        return ((amplitude * numpy.sin(angle)).sum(axis=0), (amplitude * omega * numpy.cos(angle)).sum(axis=0),
                (-amplitude * omega ** 2 * numpy.sin(angle)).sum(axis=0))


class Moves:
    """Moves at constant speed to and fro with smooth ramps: the speed rises by 3x^2 - 2x^3."""

    def __init__(self, rng, duration_s, travel):
        self.parts = []  # (start_s, ramp_s, speed change)
        at_s, position = rng.uniform(0.0, 0.3), 0.0
        pace_s = rng.uniform(0.8, 3.0)
        self.shortest_ramp_s = math.inf
        while at_s < duration_s:
            target = rng.uniform(-1.0, 1.0) * travel
            distance = target - position
            if abs(distance) < 0.25 * travel:
                continue
            move_s = pace_s * rng.uniform(0.6, 1.8)
            ramp_s = move_s * rng.uniform(0.15, 0.4)
            speed = distance / (move_s - ramp_s)
            self.parts += [(at_s, ramp_s, speed), (at_s + move_s - ramp_s, ramp_s, -speed)]
            self.shortest_ramp_s = min(self.shortest_ramp_s, ramp_s)
            at_s += move_s + (rng.uniform(0.05, 0.3) if rng.random() < 0.3 else 0.0)
            position = target
        self.highest_hz = 0.8 / self.shortest_ramp_s

    def at(self, time_s):
        position, speed, acceleration = (numpy.zeros_like(time_s) for _ in range(3))
        for start_s, ramp_s, change in self.parts:
            x = (time_s - start_s) / ramp_s
            ramp = x.clip(0.0, 1.0)
            position += change * ramp_s * (ramp ** 3 - 0.5 * ramp ** 4 + (x - 1.0).clip(0.0))
            speed += change * (3.0 * ramp ** 2 - 2.0 * ramp ** 3)
            acceleration += change / ramp_s * (6.0 * ramp - 6.0 * ramp ** 2)
        return position, speed, acceleration


def draw_trajectory(rng, duration_s, travel, fastest_hz):
    which = rng.choice(["multi_sine", "moves", "two_tone"], p=[0.5, 0.35, 0.15])
    if which == "moves":
        return Moves(rng, duration_s, travel)
    lowest_hz = rng.uniform(3.0, 6.0) / duration_s
    highest_hz = max(min(rng.uniform(0.8, 3.0), fastest_hz), 2.0 * lowest_hz)
    return MultiSine(rng, int(rng.integers(4, 8)) if which == "multi_sine" else 2, lowest_hz, highest_hz, travel)
