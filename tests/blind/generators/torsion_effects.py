# SPDX-License-Identifier: Apache-2.0
"""What may hide in a lock test, by several laws for each name. `loop` is the LoopModel that asks."""
import dataclasses
import math

import numpy

from .model import Effect, pick
from .torsion import Logarithm, Maxwell, Power

ARCMIN = 180.0 * 60.0 / math.pi


def _changed(name, law, change, first, most, describe=lambda scale: {}, signature=None):
    return Effect(name, law, lambda torsion, scale: dataclasses.replace(torsion, **change(torsion, scale)), describe, first, most, signature)


def _series(name, law, function, first, most, describe=lambda scale: {}, signature=None):
    """`function(time_s, torque_Nm)` in arcmin at scale 1."""
    return _changed(name, law, lambda torsion, scale: {"after": torsion.after + (lambda t, torque: scale * function(t, torque) / ARCMIN,)},
                    first, most, describe, signature)


def _shaped(name, law, function, first, most, describe=lambda scale: {}):
    """`function(twist, torque, scale)` replaces the spring's torque."""
    return _changed(name, law, lambda torsion, scale: {"shape": lambda twist, torque: function(twist, torque, scale)}, first, most, describe)


def make(loop, name, rng):
    peak, most_twist = loop.peak_Nm, loop.most_twist
    sign = float(rng.choice([-1.0, 1.0]))
    if name == "backlash":
        law, half_Nm = pick(rng, "dead_zone_in_series", "soft_in_series", "dead_zone_in_the_spring"), rng.uniform(0.1, 0.4)
        width = lambda scale: {"width": (scale, "arcmin")}
        if law == "dead_zone_in_series":
            return _series(name, law, lambda t, torque: 0.5 * (torque / half_Nm).clip(-1.0, 1.0), 0.05, 3.0, width)
        if law == "soft_in_series":
            return _series(name, law, lambda t, torque: numpy.arctan(torque / half_Nm) / math.pi, 0.05, 3.0)
        left, torsion = rng.uniform(0.01, 0.04), loop.torsion

        def gap(twist, torque, scale):  # teeth out of contact, friction still at work beside them
            over = numpy.sign(twist) * (numpy.abs(twist) - 0.5 * scale / ARCMIN).clip(0.0)
            return torsion.spring(over) + left * torsion.k1 * (twist - over)
        return _shaped(name, law, gap, 0.05, 2.0, width)
    if name == "asymmetric_stiffness":
        law, soft = pick(rng, "smooth", "kinked_at_equal_twist", "preloaded"), rng.uniform(0.05, 0.2) * peak
        if law == "smooth":
            return _shaped(name, law, lambda twist, torque, s: torque * (1.0 + 0.5 * sign * s * numpy.tanh(torque / soft)), 0.02, 0.5)
        if law == "kinked_at_equal_twist":
            return _shaped(name, law, lambda twist, torque, s: torque * (1.0 + 0.5 * sign * s * numpy.sign(twist)), 0.02, 0.5)
        return _shaped(name, law, lambda twist, torque, s: torque + sign * s * peak * (twist / most_twist) ** 2, 0.01, 0.3)
    if name == "cubic_hardening":
        law = pick(rng, "hyperbolic_sine", "from_half_the_way", "cube")
        shapes = {"hyperbolic_sine": lambda x: (numpy.sinh(2.5 * x) - 2.5 * x) / (math.sinh(2.5) - 2.5), "cube": lambda x: x ** 3,
                  "from_half_the_way": lambda x: numpy.sign(x) * ((numpy.abs(x) - 0.3) / 0.7).clip(0.0) ** 2.5}
        return _shaped(name, law, lambda twist, torque, s: torque + s * peak * shapes[law](twist / most_twist), 0.02, 0.6)
    if name == "creep":
        return _creep(loop, rng)
    if name == "brake_slip":
        return _slip(loop, rng, sign)
    if name == "thermal_drift":
        law = pick(rng, "measured_temperature_lagged", "two_time_constants", "room")
        share = lambda t: (t - t[0]) / (t[-1] - t[0])
        laws = {"measured_temperature_lagged": lambda t, torque: _lagged(t, loop.temperature_degC(t) - loop.temperature_degC(t[:1]), 0.04),
                "two_time_constants": lambda t, torque: 1.0 - 0.6 * numpy.exp(-share(t) / 0.3) - 0.4 * numpy.exp(-share(t) / 1.5),
                "room": lambda t, torque: numpy.sin(2.2 * share(t)) ** 2}
        if loop.has_temperature:
            law = "measured_temperature_lagged"
        return _series(name, law, lambda t, torque: sign * laws[law](t, torque), 0.05, 3.0)
    if name == "torque_zero_offset":
        return _changed(name, "transducer", lambda torsion, scale: {"torque_zero_Nm": sign * scale}, 0.05, 3.0,
                        lambda scale: {"offset": (sign * scale, "Nm")})
    if name == "distributed_friction":
        law, base = pick(rng, "iwan_even_yields", "dahl_series", "two_populations"), loop.torsion.yields[0]
        yields = {"iwan_even_yields": base * numpy.linspace(0.3, rng.uniform(10.0, 20.0), 12),
                  "dahl_series": base * rng.uniform(3.0, 6.0) * -numpy.log(1.0 - (numpy.arange(12) + 0.5) / 12.0),
                  "two_populations": base * numpy.array([0.5, 0.7, 0.9, 8.0, 11.0, 15.0, 20.0])}[law]

        def spread(torsion, scale):
            level = torsion.levels[0]
            return {"levels": (level * (1.0 - scale),) + (level * scale / len(yields),) * len(yields),
                    "yields": torsion.yields + tuple(yields.tolist())}
        return _changed(name, law, spread, 0.2, 1.0)
    law, rate = pick(rng, "power_of_rate", "logarithm_of_rate", "maxwell_branch"), loop.typical_rate
    level = loop.torsion.levels[0]
    branch = {"power_of_rate": lambda s: lambda: Power(s * level, rate, power), "logarithm_of_rate": lambda s: lambda: Logarithm(s * level, 0.1 * rate),
              "maxwell_branch": lambda s: lambda: Maxwell(s * level / (rate * tau_s), tau_s)}
    # A branch that relaxes slowly lets the twist go on at constant torque, which is creep: it is over within a few samples.
    power, tau_s = rng.uniform(0.5, 0.8), rng.uniform(1.0, 3.0) * loop.seconds / len(loop.time_s)
    return _changed(name, law, lambda torsion, scale: {"rate": branch[law](scale)}, 0.1, 3.0)


def _lagged(time_s, values, share):
    out, part = numpy.array(values, dtype=float), 1.0 - numpy.exp(-numpy.diff(time_s) / (share * (time_s[-1] - time_s[0])))
    for k, step in enumerate(part.tolist(), 1):
        out[k] = out[k - 1] + step * (values[k] - out[k - 1])
    return out


def _creep(loop, rng):
    law, span_s = pick(rng, "one_lag", "power_of_time", "logarithm_of_time"), loop.seconds
    unit, tau_s = ARCMIN / loop.torsion.k2, loop.seconds * rng.uniform(0.04, 0.12)

    def flow(t, torque):
        """Boltzmann's superposition: each change of torque flows by the law of the time since then, on a grid of 400 moments."""
        if law == "one_lag":
            return unit * _lagged(t, torque, tau_s / (t[-1] - t[0]))
        grid = numpy.linspace(t[0], t[-1], 400)
        changes = numpy.diff(numpy.interp(grid, t, torque), prepend=0.0)
        since = grid - grid[0]
        after = (since / span_s) ** 0.3 if law == "power_of_time" else numpy.log1p(since / (0.01 * span_s)) / math.log(101.0)
        return unit * numpy.interp(t, grid, numpy.convolve(changes, after)[:400])
    return _series("creep", law, flow, 0.02, 0.4, lambda scale: {"time_constant": (tau_s, "s")} if law == "one_lag" else {})


def _slip(loop, rng, sign):
    law, level_Nm = pick(rng, "slides_with_the_excess", "gives_way_and_hardens", "in_small_slips"), loop.peak_Nm * rng.uniform(0.55, 0.85)
    counts = rng.integers(6, 14)

    def slipped(t, torque):
        beyond = (sign * torque - level_Nm).clip(0.0) / (loop.peak_Nm - level_Nm)
        if law == "gives_way_and_hardens":  # the same torque again does nothing
            return sign * numpy.maximum.accumulate(beyond)
        way = numpy.concatenate([[0.0], numpy.cumsum(0.5 * (beyond[1:] + beyond[:-1]) * numpy.diff(t))]) / loop.seconds
        if law == "slides_with_the_excess":
            return sign * 10.0 * way
        # Slips of one size as often as the way asks for it.
        step = max(float(way[-1]), 1e-12) / counts
        return sign * 10.0 * step * numpy.floor(way / step + 0.5)
    return _series("brake_slip", law, slipped, 0.1, 6.0, lambda scale: {"level": (level_Nm, "Nm")})


def make_outside(loop, rng):
    law, peak, span_s = pick(rng, "tone_that_fades", "shift_in_window", "hump_at_a_torque"), loop.peak_Nm, loop.seconds
    amplitude = lambda scale: {"amplitude": (scale, "arcmin")}
    if law == "tone_that_fades":
        hertz, phase = 10.0 ** rng.uniform(math.log10(30.0 / span_s), math.log10(0.1 * len(loop.time_s) / span_s)), rng.uniform(0.0, 6.0)
        return _series(law, law, lambda t, torque: (1.0 - 0.6 * t / t[-1]) * numpy.sin(2.0 * math.pi * hertz * t + phase), 0.05, 2.0, amplitude,
                       {"what": "order", "regressor": "time", "values": [hertz, 1.0 / hertz, 2.0 * math.pi * hertz],
                        "tolerance": max(0.02, 0.5 / span_s / hertz), "relative": True})
    if law == "shift_in_window":
        start_s, length_s = rng.uniform(0.15, 0.7) * span_s, rng.uniform(0.06, 0.2) * span_s

        def window(t, torque):
            return ((t - start_s) / (0.1 * length_s)).clip(0.0, 1.0) * ((start_s + length_s - t) / (0.1 * length_s)).clip(0.0, 1.0)
        return _series(law, law, window, 0.05, 2.0, amplitude,
                       {"what": "window", "regressor": "time", "window": [start_s, start_s + length_s], "values": [], "tolerance": 0.0,
                        "unit": "s"})
    level_Nm, width_Nm = float(rng.choice([-1.0, 1.0])) * rng.uniform(0.3, 0.75) * peak, rng.uniform(0.05, 0.12) * peak
    return _series(law, law, lambda t, torque: numpy.exp(-0.5 * ((torque - level_Nm) / width_Nm) ** 2), 0.05, 2.0, amplitude,
                   {"what": "window", "regressor": "torque", "values": [], "tolerance": 0.0, "unit": "Nm",
                    "window": [level_Nm - 1.5 * width_Nm, level_Nm + 1.5 * width_Nm]})
