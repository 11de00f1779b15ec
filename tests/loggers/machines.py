# SPDX-License-Identifier: Apache-2.0
"""Healthy machines and their records before any logger has touched them: torsion loops, transmission-error sweeps, an axis, vibration.

A share of 1 % and the floors below are what the reports of users ask of a clean record; inertia and friction have 3 %.
"""
import math

import numpy

from record import Record, Truth

# T1, T2, T3 in Nm and K1, K2, K3 in Nm/rad of gears as their data sheets have them, rounded.
SIZES = ((2.0, 6.9, 18.0, 4700.0, 6100.0, 7100.0), (7.0, 25.0, 34.0, 16000.0, 25000.0, 29000.0),
         (14.0, 48.0, 92.0, 31000.0, 50000.0, 57000.0), (29.0, 108.0, 137.0, 67000.0, 110000.0, 120000.0))
ARCMIN = 180.0 * 60.0 / math.pi


def spring_Nm(twist_rad, knees_Nm, slopes):
    """Odd, continuous, piecewise linear."""
    first = knees_Nm[0] / slopes[0]
    second = first + (knees_Nm[1] - knees_Nm[0]) / slopes[1]
    return numpy.interp(numpy.abs(twist_rad), [0.0, first, second, second + 1.0],
                        [0.0, knees_Nm[0], knees_Nm[1], knees_Nm[1] + slopes[2]]) * numpy.sign(twist_rad)


def friction_Nm(twist_rad, level_Nm, yield_rad):
    """An elasto-plastic element that is carried along the twists in their order."""
    held, levels = 0.0, [0.0]
    for move in (numpy.diff(twist_rad) * level_Nm / yield_rad).tolist():
        held = min(max(held + move, -level_Nm), level_Nm)
        levels.append(held)
    return numpy.array(levels)


def zero_crossings(torque_Nm, twist_rad):
    """Twist where the torque goes through zero, falling and rising."""
    found = {-1: [], 1: []}
    for k in numpy.nonzero(torque_Nm[:-1] * torque_Nm[1:] < 0.0)[0]:
        share = torque_Nm[k] / (torque_Nm[k] - torque_Nm[k + 1])
        found[1 if torque_Nm[k + 1] > 0.0 else -1].append(twist_rad[k] + share * (twist_rad[k + 1] - twist_rad[k]))
    return numpy.mean(found[-1]), numpy.mean(found[1])


def torsion_loop(rng):
    t1, t2, t3, *slopes = SIZES[rng.integers(len(SIZES))]
    slopes = numpy.array(slopes) * rng.uniform(0.85, 1.15)
    level_Nm, yield_rad = t3 * rng.uniform(0.012, 0.05), rng.uniform(0.15, 0.4) / ARCMIN
    top_rad = numpy.interp(t3 - level_Nm, spring_Nm(numpy.linspace(0.0, 0.01, 20001), (t1, t2), slopes),
                           numpy.linspace(0.0, 0.01, 20001))
    corners = [0.0] + [top_rad, -top_rad] * int(rng.integers(1, 3)) + [top_rad]
    way = numpy.concatenate([[0.0], numpy.cumsum(numpy.abs(numpy.diff(corners)))])
    steps = int(rng.integers(700, 1500))
    fine = 20  # the physics runs on a finer grid than the samples
    twist_rad = numpy.interp(numpy.linspace(0.0, way[-1], fine * (steps - 1) + 1), way, corners)
    torque_Nm = spring_Nm(twist_rad, (t1, t2), slopes) + friction_Nm(twist_rad, level_Nm, yield_rad)
    falling, rising = zero_crossings(torque_Nm, twist_rad)
    truth = {"k%d_Nm_per_rad" % (k + 1): Truth(float(slopes[k]), 0.01, 0.0) for k in range(3)}
    truth["hysteresis_arcmin"] = Truth(float(abs(falling - rising)) * ARCMIN, 0.02, 0.005)
    truth["friction_torque_Nm"] = Truth(float(level_Nm), 0.05, 0.0)
    columns = {"time_s": numpy.arange(steps) / float(rng.choice([10.0, 25.0, 50.0])), "torque_Nm": torque_Nm[::fine],
               "output_angle_deg": numpy.degrees(twist_rad[::fine])}
    noise = {"torque_Nm": t3 * rng.uniform(2e-4, 1e-3), "output_angle_deg": 10.0 ** rng.uniform(-5.0, -4.3)}
    if rng.random() < 0.3:
        columns["temperature_degC"], noise["temperature_degC"] = numpy.full(steps, 24.0), 0.05
    metadata = {"kind": "hysteresis", "t1_Nm": "%g" % t1, "t2_Nm": "%g" % t2, "t3_Nm": "%g" % t3}
    return Record("hysteresis", metadata, columns, noise, {"time_s": 3, "torque_Nm": 4, "output_angle_deg": 7}, truth, {},
                  {"output_angle_deg": 360.0})


def sweep(rng):
    ratio = float(rng.choice([50.0, 80.0, 100.0, 120.0, -100.0]))
    second, eccentric = rng.uniform(0.2, 1.0), rng.choice([0.0, rng.uniform(0.15, 0.5)])
    lost = rng.choice([0.0, rng.uniform(0.1, 0.6) * rng.choice([-1.0, 1.0])])
    absolute, both = rng.random() < 0.6, rng.random() < 0.7
    rows = int(rng.choice([430, 700, 1440]))  # none at which two harmonics of the wave generator fall together
    share = numpy.arange(rows + 1) / rows
    start_deg = rng.uniform(0.0, 360.0)
    there = start_deg + 360.0 * share
    target_deg = numpy.concatenate([there, there[::-1]]) if both else there
    sense = numpy.concatenate([numpy.ones(rows + 1), -numpy.ones(rows + 1)]) if both else numpy.ones(rows + 1)
    input_deg = ratio * target_deg + rng.normal(0.0, 0.3, len(target_deg))
    place = numpy.radians(input_deg)
    level = rng.uniform(-0.8, 0.8) if absolute else 0.0
    error = level + second * numpy.sin(2.0 * place + rng.uniform(0.0, 6.28)) \
        + eccentric * numpy.sin(place / ratio + rng.uniform(0.0, 6.28)) + 0.5 * lost * sense
    zero = 0.0 if absolute else error[0]
    sd_arcmin = 10.0 ** rng.uniform(-2.5, -1.8)
    floor = 0.01 + (0.0 if absolute else 4.0 * sd_arcmin)  # the first sample is the zero of a record that is not absolute
    truth = {"second_harmonic_amplitude_arcmin": Truth(second, 0.03, 0.005)}
    for name, sign in (("", 1.0), ("_ccw", -1.0)):
        part = error[sense == sign]
        if len(part):
            truth["e_avg%s_arcmin" % name] = Truth(level + 0.5 * lost * sign - zero, 0.0, floor)
            # The extremes of so many samples lie up to four standard deviations of noise beyond those of the gear.
            truth["e_max%s_arcmin" % name] = Truth(float(part.max() - part.min()), 0.02, 0.03 + 8.0 * sd_arcmin)
    if both:
        truth["lost_motion_arcmin"] = Truth(lost, 0.02, 0.01)
    causes = {}
    if lost:
        causes["backlash"] = {"backlash_arcmin": Truth(lost, 0.03, 0.01)} if both else {}
    if eccentric:
        causes["output_eccentricity"] = {"amplitude_arcmin": Truth(eccentric, 0.03, 0.005)}
    columns = {"direction": ["cw" if way > 0.0 else "ccw" for way in sense], "input_angle_deg": input_deg,
               "output_angle_deg": input_deg / ratio - error / 60.0}
    if rng.random() < 0.5:
        columns = {"time_s": numpy.arange(len(sense)) * rng.choice([0.05, 0.5]), **columns}
    metadata = {"kind": "transmission_error", "ratio": "%g" % ratio, **({"absolute": "true"} if absolute else {})}
    return Record("transmission_error", metadata, columns, {"output_angle_deg": sd_arcmin / 60.0},
                  {"input_angle_deg": 4, "output_angle_deg": 7, "time_s": 2}, truth, causes,
                  {"input_angle_deg": 360.0, "output_angle_deg": 360.0})


def axis(rng):
    rate_hz = float(rng.choice([100.0, 200.0, 250.0]))
    time_s = numpy.arange(int(rng.uniform(10.0, 20.0) * rate_hz)) / rate_hz
    position, speed, acceleration = numpy.zeros((3, len(time_s)))
    for hz, size in zip(rng.uniform(0.25, 0.9, 3), rng.uniform(0.4, 1.6, 3)):
        omega, phase = 2.0 * math.pi * hz, rng.uniform(0.0, 6.28)
        position += size * numpy.sin(omega * time_s + phase)
        speed += size * omega * numpy.cos(omega * time_s + phase)
        acceleration -= size * omega ** 2 * numpy.sin(omega * time_s + phase)
    inertia = 10.0 ** rng.uniform(-2.0, 0.0)
    scale = inertia * float(numpy.std(acceleration))
    coulomb, viscous = scale * rng.uniform(0.3, 0.8), scale * rng.uniform(0.1, 0.5) / float(numpy.std(speed))
    offset = coulomb * rng.uniform(-0.2, 0.2)
    torque = inertia * acceleration + viscous * speed + coulomb * numpy.sign(speed) + offset
    columns = {"time_s": time_s, "position_rad": position, "torque_Nm": torque}
    noise = {"torque_Nm": scale * rng.uniform(0.01, 0.04), "position_rad": 2e-6}
    if rng.random() < 0.5:
        columns["velocity_rad_per_s"], noise["velocity_rad_per_s"] = speed, 2e-3
    metadata = {"kind": "motion", **({"inertia_kgm2": "%.6g" % inertia} if rng.random() < 0.5 else {})}
    truth = {"inertia_kgm2": Truth(inertia, 0.03, 0.0), "viscous_Nms_per_rad": Truth(viscous, 0.03, 0.0),
             "coulomb_Nm": Truth(coulomb, 0.03, 0.0), "offset_Nm": Truth(offset, 0.0, 0.03 * coulomb)}
    decimals = {"time_s": 4, "position_rad": 7, "torque_Nm": 6, "velocity_rad_per_s": 5}
    return Record("motion", metadata, columns, noise, decimals, truth, {}, {"position_rad": 2.0 * math.pi})


def shaft(rng):
    rate_hz = float(rng.choice([5120.0, 8192.0, 12800.0]))
    time_s = numpy.arange(int(rng.uniform(0.8, 1.5) * rate_hz)) / rate_hz
    speed_rpm = rng.uniform(900.0, 3000.0)
    turn = 2.0 * math.pi * speed_rpm / 60.0 * time_s
    columns, noise, truth = {}, {}, {}
    for name in ("accel_x_m_per_s2", "accel_z_m_per_s2")[:int(rng.integers(1, 3))]:
        first, second = rng.uniform(0.5, 3.0, 2)
        columns[name] = first * numpy.cos(turn + rng.uniform(0.0, 6.28)) + second * numpy.cos(2.0 * turn + rng.uniform(0.0, 6.28))
        noise[name] = rng.uniform(0.2, 0.6)
        truth["first_amplitude_" + name], truth["second_amplitude_" + name] = Truth(first, 0.03, 0.0), Truth(second, 0.03, 0.0)
    metadata = {"kind": "vibration", "ratio": "80", "input_speed_rpm": "%.6g" % speed_rpm}
    if rng.random() < 0.5:
        columns = {"time_s": time_s, **columns}
    if "time_s" not in columns or rng.random() < 0.3:
        metadata["sample_rate_hz"] = "%g" % rate_hz
    return Record("vibration", metadata, columns, noise, {"time_s": 9, "accel_x_m_per_s2": 4, "accel_z_m_per_s2": 4}, truth, {})


MACHINES = {"hysteresis": torsion_loop, "transmission_error": sweep, "motion": axis, "vibration": shaft}
