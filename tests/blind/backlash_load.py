# SPDX-License-Identifier: Apache-2.0
"""A second inertia behind a spring or behind a gap, integrated on a grid much finer than the samples.

The motor side follows the prescribed path; what the load does shows as the torque it fails to ask for, or asks for too much,
compared with a load that is held tight. Both functions return that torque per unit of load inertia.
"""
import math

import numpy


def _grid(duration_s, step_s):
    count = max(int(math.ceil(1.02 * duration_s / step_s)) + 2, 16)
    return step_s * numpy.arange(count)


def resonance_reaction(path, duration_s, natural_hz, damping_ratio):
    """Load on a lightly damped spring: with r = load minus motor, r'' + 2 z w r' + w^2 r = -a. Runge-Kutta of order 4."""
    step_s = 1.0 / (40.0 * natural_hz)
    grid_s = _grid(duration_s, step_s)
    omega = 2.0 * math.pi * natural_hz
    drag = 2.0 * damping_ratio * omega
    stiff = omega * omega
    halves = (-path.at(numpy.arange(2 * len(grid_s)) * 0.5 * step_s)[2]).tolist()
    # It starts as it would ride along in steady motion: bent by the first acceleration.
    r, s = halves[0] / stiff, 0.0
    reaction = [0.0] * len(grid_s)
    for k in range(len(grid_s)):
        a0, a1, a2 = halves[2 * k], halves[2 * k + 1], halves[min(2 * k + 2, len(halves) - 1)]
        acceleration = a0 - drag * s - stiff * r
        reaction[k] = acceleration
        k1r, k1s = s, acceleration
        k2r = s + 0.5 * step_s * k1s
        k2s = a1 - drag * k2r - stiff * (r + 0.5 * step_s * k1r)
        k3r = s + 0.5 * step_s * k2s
        k3s = a1 - drag * k3r - stiff * (r + 0.5 * step_s * k2r)
        k4r = s + step_s * k3s
        k4s = a2 - drag * k4r - stiff * (r + step_s * k3r)
        r += step_s / 6.0 * (k1r + 2.0 * k2r + 2.0 * k3r + k4r)
        s += step_s / 6.0 * (k1s + 2.0 * k2s + 2.0 * k3s + k4s)
    table = numpy.array(reaction)
    # r'' is what the load accelerates beyond the motor: the extra torque on the drive per unit of load inertia.
    return lambda time_s: numpy.interp(time_s, grid_s, table)


def backlash_reaction(path, duration_s, contact_hz, damping_ratio, load_friction):
    """Load behind a gap, with dry friction of its own (as an acceleration) and damped contact. Semi-implicit Euler."""
    step_s = 1.0 / (30.0 * contact_hz)
    grid_s = _grid(duration_s, step_s)
    motor, motor_speed, _ = path.at(grid_s)
    stiff = (2.0 * math.pi * contact_hz) ** 2
    drag = 2.0 * damping_ratio * 2.0 * math.pi * contact_hz
    positions, speeds = motor.tolist(), motor_speed.tolist()

    def contact(gap):
        half = 0.5 * gap
        load, speed = positions[0] - half * math.copysign(1.0, speeds[0]), speeds[0]
        transmitted = [0.0] * len(positions)
        for k in range(len(positions)):
            lead, closing = positions[k] - load, speeds[k] - speed
            push = 0.0
            if lead > half:
                push = max(stiff * (lead - half) + drag * closing, 0.0)
            elif lead < -half:
                push = min(stiff * (lead + half) + drag * closing, 0.0)
            transmitted[k] = push
            # Dry friction that never turns a standing load round: it is limited to what stops it within the step.
            free = speed + step_s * push
            stop = min(max(free, -step_s * load_friction), step_s * load_friction)
            speed = free - stop
            load += step_s * speed
        return numpy.array(transmitted)

    # The same contact without a gap is a little compliant too; only what the gap does is the effect.
    closed = contact(0.0)
    cache = {}

    def reaction(gap, time_s):
        if gap not in cache:
            if len(cache) > 3:
                cache.clear()
            cache[gap] = contact(gap) - closed
        return numpy.interp(time_s, grid_s, cache[gap])
    return reaction
