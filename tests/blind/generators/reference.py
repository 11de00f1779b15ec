# SPDX-License-Identifier: Apache-2.0
"""What an axis is told to do: positions on the grid of its controller. Speed and acceleration are differences of them."""
import math

import numpy


def _boxcar(values, length):
    """Mean over the last `length` samples; before the first one it stood there."""
    padded = numpy.concatenate([numpy.full(length, values[0]), values])
    sums = numpy.cumsum(padded)
    return (sums[length:] - sums[:-length]) / length


def jerk_limited_moves(rng, count, step_s, travel):
    """Steps of position through three moving averages: speed, acceleration and jerk are limited (S-curves), with dwells."""
    targets, at = numpy.zeros(count), 0
    pace_s = rng.uniform(0.5, 1.2)
    level = 0.0
    while at < count:
        level = travel * rng.uniform(-1.0, 1.0) if abs(level) < 0.3 * travel else -math.copysign(travel, level) * rng.uniform(0.2, 1.0)
        hold = int(pace_s * rng.uniform(1.0, 2.2) / step_s)
        targets[at:at + hold] = level
        at += hold
    targets[:int(0.1 / step_s)] = 0.0
    for share in (0.7, 0.35, 0.12):
        targets = _boxcar(targets, max(int(share * pace_s / step_s), 1))
    return targets


def chirp(rng, count, step_s, travel):
    """A sine of rising frequency whose speed stays about the same."""
    time_s = step_s * numpy.arange(count)
    first_hz, last_hz = rng.uniform(0.15, 0.4), rng.uniform(1.2, 2.5)
    hertz = first_hz * (last_hz / first_hz) ** (time_s / time_s[-1])
    phase = 2.0 * math.pi * numpy.cumsum(hertz) * step_s
    fade_in = numpy.minimum(time_s / 0.5, 1.0) ** 2 * (3.0 - 2.0 * numpy.minimum(time_s / 0.5, 1.0))
    return travel * (first_hz / hertz) ** 0.7 * numpy.sin(phase) * fade_in


def schroeder_multisine(rng, count, step_s, travel):
    """Harmonics of one period with Schroeder's phases, which keep its crest low (Schroeder 1970); power falls with frequency."""
    time_s = step_s * numpy.arange(count)
    base_hz, tones = rng.uniform(0.12, 0.25), int(rng.integers(5, 10))
    path = numpy.zeros(count)
    for k in range(1, tones + 1):
        path += k ** -1.1 * numpy.cos(2.0 * math.pi * k * base_hz * time_s - math.pi * k * (k - 1) / tones)
    fade_in = numpy.minimum(time_s / 0.4, 1.0) ** 2 * (3.0 - 2.0 * numpy.minimum(time_s / 0.4, 1.0))
    return travel * (path - path[0]) / numpy.max(numpy.abs(path - path[0])) * fade_in


def ramps_to_and_fro(rng, count, step_s, travel):
    """A triangle of changing pace through two moving averages: long segments at constant speed, each at another one."""
    corners, at_s, level = [(0.0, 0.0), (0.15, 0.0)], 0.15, 0.0
    side = float(rng.choice([-1.0, 1.0]))
    while at_s < count * step_s:
        goal = side * travel * rng.uniform(0.4, 1.0)
        at_s += abs(goal - level) / travel * rng.uniform(0.4, 2.2)
        corners.append((at_s, goal))
        level, side = goal, -side
    times, levels = numpy.array(corners).T
    path = numpy.interp(step_s * numpy.arange(count), times, levels)
    for seconds in (rng.uniform(0.08, 0.15), rng.uniform(0.04, 0.07)):
        path = _boxcar(path, int(seconds / step_s))
    return path
