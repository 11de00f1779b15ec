# SPDX-License-Identifier: Apache-2.0
"""What may hide in a vibration, by several laws for each name. `machine` is the VibrationModel that asks."""
import math

import numpy

from .model import Effect, pick

MESH_ORDER = 162.0  # teeth of the circular spline, that each lobe of the wave generator passes once a turn
RATIO = 80.0
MOST_M_PER_S2 = 30.0
MODULATIONS = 2.0  # per input turn: each lobe of the wave generator is a zone of load


def _shaped(machine, name, law, shape, describe=lambda scale: {}, signature=None, by_chance=False):
    """`shape`: channels x samples, scaled so that its strongest channel has an rms of 1."""
    shape = shape / max(float(numpy.sqrt((shape ** 2).mean(axis=1)).max()), 1e-12)
    return Effect(name, law, lambda scale: scale * shape, describe, 0.3 * machine.noise.sd, MOST_M_PER_S2, signature, by_chance)


def _pulses(machine, angles, heights):
    """Impulses at angles of the input, each shared by the two samples that it falls between."""
    out = numpy.zeros(len(machine.time_s))
    at = numpy.interp(angles, machine.angle_rad, numpy.arange(len(out)), left=-1.0, right=-1.0)
    inside = (at >= 0.0) & (at < len(out) - 1)
    first = at[inside].astype(int)
    numpy.add.at(out, first, heights[inside] * (1.0 - at[inside] + first))
    numpy.add.at(out, first + 1, heights[inside] * (at[inside] - first))
    return out


def make(machine, name, rng):
    m, angle, phase = machine, machine.angle_rad, rng.uniform(-math.pi, math.pi)
    if name == "gear_mesh":
        law, depth = pick(rng, "amplitude_and_phase_modulated", "two_rings_that_beat", "sharp_engagement"), rng.uniform(0.2, 0.6)
        if law == "amplitude_and_phase_modulated":
            force = (1.0 + depth * numpy.cos(MODULATIONS * angle + phase)) * \
                numpy.cos(MESH_ORDER * angle + 0.5 * depth * numpy.sin(MODULATIONS * angle + 2.0 * phase))
        elif law == "two_rings_that_beat":
            force = numpy.cos(MESH_ORDER * angle + phase) + depth * numpy.cos((MESH_ORDER - 2.0) * angle - phase)
        else:
            inside = MESH_ORDER * 2.0 * m.speed_rpm.max() / 60.0 < 0.45 * m.rate_hz
            force = numpy.cos(MESH_ORDER * angle) + (0.3 * depth * numpy.cos(2.0 * MESH_ORDER * angle + phase) if inside else 0.0)
            force = force * (1.0 + 0.5 * depth * numpy.cos(MODULATIONS * angle + phase) ** 3)
        return _shaped(m, name, law, m.through(force))
    if name == "bearing_defect":
        return _bearing(m, rng, phase)
    if name == "imbalance":
        law, sense = pick(rng, "elliptical_orbit", "soft_support", "seen_along_the_axis"), float(rng.choice([-1.0, 1.0]))
        ratio = m.speed_rpm / m.mean_rpm
        square, late = ratio ** 2, 0.0
        if law == "soft_support":  # a Jeffcott rotor well below its critical speed
            critical = rng.uniform(3.0, 5.0)
            square, late = square / (1.0 - (ratio / critical) ** 2), 0.05 * ratio
        gains = {"accel_x": 1.0, "accel_y": rng.uniform(0.5, 0.9) if law == "elliptical_orbit" else 1.0}
        if law == "seen_along_the_axis":
            gains["accel_z"] = rng.uniform(0.1, 0.3)
        turns = {"accel_y": -0.5 * math.pi * sense, "accel_z": 1.0}
        shape = numpy.stack([gains.get(channel, 0.0) * square * numpy.cos(angle + phase - late + turns.get(channel, 0.0)) for channel in m.names])
        return _shaped(m, name, law, shape)
    return _resonance(m, rng, phase) if name == "torsional_resonance" else _crack(m, rng, phase)


def _bearing(m, rng, phase):
    law, balls = pick(rng, "slip_that_adds_up", "spall_with_noise", "two_zones_of_load"), int(rng.integers(19, 26))
    order = 0.5 * balls * (1.0 + float(rng.choice([-1.0, 1.0])) * rng.uniform(0.07, 0.13))
    first, last = m.angle_rad[0], m.angle_rad[-1]
    count = int((last - first) / (2.0 * math.pi) * order)
    slip = 1.0 + (0.004 if law == "slip_that_adds_up" else 0.001) * rng.standard_normal(count)
    slip /= slip.mean()  # the order is the one that came about
    angles = first + 2.0 * math.pi / order * (rng.random() + numpy.cumsum(slip))  # slip adds up from impact to impact
    depth = rng.uniform(0.3, 0.8)
    heights = 1.0 + depth * numpy.cos(MODULATIONS * angles + phase)
    describe = lambda scale: {"order": (order, "1/rev")}
    if law == "spall_with_noise":  # rolled over for a while: noise that comes and goes
        width = rng.uniform(0.05, 0.12)
        since = (order * (m.angle_rad - first) / (2.0 * math.pi) + phase) % 1.0
        gate = numpy.exp(-0.5 * (numpy.minimum(since, 1.0 - since) / width) ** 2)
        force = gate * (1.0 + depth * numpy.cos(MODULATIONS * m.angle_rad + phase)) * rng.standard_normal(len(m.time_s))
        return _shaped(m, "bearing_defect", law, m.through(force), describe, by_chance=True)
    if law == "two_zones_of_load":
        heights = numpy.abs(numpy.cos(0.5 * MODULATIONS * angles + phase)) ** 1.5 * (1.0 + 0.1 * rng.standard_normal(count))
    return _shaped(m, "bearing_defect", law, m.through(_pulses(m, angles, heights)), describe, by_chance=True)


def _resonance(m, rng, phase):
    turn_hz, law = m.mean_rpm / 60.0, pick(rng, "impacts", "driven_by_noise", "crossed_by_order_2")
    span_s = m.time_s[-1]
    if law == "crossed_by_order_2" and numpy.ptp(m.speed_rpm) < 0.1 * m.mean_rpm:
        law = "driven_by_noise"
    for _ in range(100):
        natural_hz, damping = 10.0 ** rng.uniform(1.6, 2.6), rng.uniform(0.005, 0.025)
        if law == "crossed_by_order_2":
            natural_hz = float(rng.uniform(*numpy.quantile(2.0 * m.speed_rpm / 60.0, [0.2, 0.8])))
        damping = max(damping, 2.0 / (span_s * natural_hz))
        near = min([abs(natural_hz - multiple * base) for base in (50.0, 60.0) for multiple in (1, 2, 3)] +
                   ([abs(natural_hz - k * turn_hz) for k in (1, 2)] if law != "crossed_by_order_2" else []))
        if damping < 0.06 and near > 3.0 * damping * natural_hz:
            break
    else:
        return None
    mode = m.mode(natural_hz, damping)
    if law == "impacts":
        force = numpy.zeros(len(m.time_s))
        at = rng.integers(int(0.02 * len(force)), int(0.85 * len(force)), int(rng.integers(1, 5)))
        force[at] = rng.choice([-1.0, 1.0], len(at)) * rng.uniform(0.5, 1.0, len(at))
    elif law == "driven_by_noise":
        force = rng.standard_normal(len(m.time_s))
    else:
        force = numpy.sin(2.0 * m.angle_rad + phase)
    # Driven as a velocity is: neither the slow force nor the fast one itself, only what rings.
    ringing = numpy.zeros_like(mode)
    ringing[1:] = 1j * mode[1:] / (m.hertz[1:] / natural_hz)
    response = numpy.fft.irfft(ringing * numpy.fft.rfft(force, 2 * len(force)), 2 * len(force))[:len(force)]
    gains = rng.uniform(0.4, 1.0, len(m.names)) * rng.choice([-1.0, 1.0], len(m.names))
    return _shaped(m, "torsional_resonance", law, gains[:, numpy.newaxis] * response,
                   lambda scale: {"frequency": (natural_hz, "Hz")}, by_chance=law == "driven_by_noise")


def _crack(m, rng, phase):
    order = 2.0 * (1.0 + 1.0 / RATIO)
    law, depth, turn = pick(rng, "breathing", "impacts_on_the_housing", "modulated_line"), rng.uniform(0.4, 0.9), rng.uniform(-3.0, 3.0)
    load = 1.0 + depth * numpy.cos(m.angle_rad / RATIO + turn)  # where the crack stands to the load, once per output turn
    if law == "breathing":  # open for half of the time
        shape = numpy.cos(order * m.angle_rad + phase).clip(0.0) ** rng.uniform(2.0, 4.0) * load
    elif law == "impacts_on_the_housing":
        first, last = m.angle_rad[0], m.angle_rad[-1]
        angles = first + 2.0 * math.pi / order * (rng.random() + numpy.arange(int((last - first) / (2.0 * math.pi) * order)))
        pulses = _pulses(m, angles, 1.0 + depth * numpy.cos(angles / RATIO + turn))
        length = max(int(0.03 * m.rate_hz * 60.0 / m.mean_rpm), 3)  # soft contact: a good part of a turn
        force = numpy.convolve(pulses, numpy.hanning(length), "same")
        return _shaped(m, "flexspline_crack", law, m.through(force) + rng.uniform(0.3, 0.8, len(m.names))[:, numpy.newaxis] * force)
    else:
        shape = (numpy.cos(order * m.angle_rad + phase) + 0.5 * numpy.cos(2.0 * order * m.angle_rad + 2.0 * phase) +
                 0.25 * numpy.cos(3.0 * order * m.angle_rad + 3.0 * phase)) * load
    gains = rng.uniform(0.4, 1.0, len(m.names))
    return _shaped(m, "flexspline_crack", law, gains[:, numpy.newaxis] * (shape - shape.mean()), lambda scale: {"order": (order, "1/rev")})


def make_outside(m, rng):
    law, turn_hz, phase = pick(rng, "whirl", "fan", "whistle"), m.mean_rpm / 60.0, rng.uniform(-math.pi, math.pi)
    gains = rng.uniform(0.4, 1.0, len(m.names))[:, numpy.newaxis]
    if law in ("whirl", "fan"):
        order = rng.uniform(0.43, 0.48) if law == "whirl" else float(rng.choice([5.31, 7.6, 9.4]))
        shape = numpy.sin(order * m.angle_rad + phase) + (0.4 * numpy.sin(2.0 * order * m.angle_rad + 2.1 * phase) if law == "fan" else 0.0)
        return _shaped(m, law, law, gains * shape, signature={"what": "order", "regressor": "input_angle", "tolerance": 0.02, "relative": True,
                                                              "values": [order, order * turn_hz, order * RATIO]})
    hertz = m.rate_hz * rng.uniform(0.2, 0.4)
    shape = numpy.sin(2.0 * math.pi * hertz * m.time_s + 0.4 * numpy.sin(2.0 * math.pi * 3.0 * m.time_s) + phase)
    return _shaped(m, law, law, gains * shape, signature={"what": "order", "regressor": "time", "values": [hertz, hertz / turn_hz], "tolerance": 0.02,
                                                          "relative": True})
