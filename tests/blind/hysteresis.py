# SPDX-License-Identifier: Apache-2.0
"""Hysteresis records: the lock test of `hysteresis_loop.py`, its torque profile, its sensors, its hidden effects."""
import dataclasses
import math

import numpy

from effect import Effect, Ruler
from hysteresis_loop import Loop, lag

CAUSES = ("backlash", "asymmetric_stiffness", "cubic_hardening", "creep", "brake_slip", "thermal_drift",
          "torque_zero_offset", "distributed_friction", "rate_dependence")
ARCMIN = 180.0 * 60.0 / math.pi
SUBSTEPS = 5  # the physics runs on a grid this much finer than the samples


class Hysteresis:
    kind = "hysteresis"
    unit = "arcmin"

    def __init__(self, rng, wants, nuisances, wrong_number=False):
        self.rho = rng.uniform(0.3, 0.8) if "coloured_noise" in nuisances else 0.0
        angle_sd_arcmin = 10.0 ** rng.uniform(-2.5, -1.5)
        self.torque_sd_Nm = rng.uniform(0.0, 0.02) if self.rho == 0.0 and rng.random() < 0.7 else 0.0
        spread = 0.55 if wrong_number else 0.25
        gains = [rng.choice([1.0 - spread, 1.0 + spread]) if wrong_number else rng.uniform(1.0 - spread, 1.0 + spread)
                 for _ in range(2)]
        stiffness = numpy.sort(numpy.array([1.6e4, 2.5e4, 2.9e4]) * gains[0] * rng.uniform(0.92, 1.08, 3))
        self.limits_Nm = (7.0, 25.0, 34.0) if rng.random() < 0.75 else tuple(
            round(value * rng.uniform(0.5, 2.0), 1) for value in (7.0, 25.0, 34.0))
        if min(numpy.diff(self.limits_Nm)) < 5.0:
            self.limits_Nm = (7.0, 25.0, 34.0)
        self.loop = Loop(*stiffness, self.limits_Nm[0], self.limits_Nm[1], rng.uniform(0.5, 3.0) * gains[1],
                         rng.uniform(0.2, 0.6) / ARCMIN, 0.0)
        self.angle_sd_arcmin = angle_sd_arcmin
        self.noise_sd = math.hypot(angle_sd_arcmin, self.torque_sd_Nm / stiffness[1] * ARCMIN)
        self._draw_profile(rng, wants, nuisances)
        self._round_knees(rng)
        self._draw_surroundings(rng, wants, nuisances)
        # Of wrong numbers half are the knees that the record itself states.
        self.stated_Nm = list(self.limits_Nm)
        if wrong_number and rng.random() < 0.5:
            share = rng.choice([-1.0, 1.0]) * rng.uniform(0.04, 0.15)
            self.stated_Nm[:2] = [round(knee_Nm * (1.0 + share * rng.uniform(0.6, 1.0)), 2) for knee_Nm in self.limits_Nm[:2]]

    def _draw_profile(self, rng, wants, nuisances):
        peak_Nm = self.limits_Nm[2]
        short = "short_record" in nuisances and "rate_dependence" not in wants
        loops = 1 if short else int(rng.choice([1, 2, 3], p=[0.3, 0.4, 0.3]))
        if "rate_dependence" in wants:
            loops = max(loops, 2)
        seconds = rng.uniform(8.0, 40.0)
        factors = numpy.ones(loops)
        if "rate_dependence" in wants or rng.random() < 0.25:
            factors = rng.permutation(numpy.geomspace(1.0, rng.uniform(4.0, 12.0), loops)) / 2.0
        hold_s = seconds * rng.uniform(0.1, 0.5) if "creep" in wants or rng.random() < 0.25 else 0.0
        smooth = rng.random() < 0.35
        corners = [(0.0, 0.0)]  # (time_s, torque_Nm)

        def go(to_Nm, factor):
            corners.append((corners[-1][0] + seconds * factor * abs(to_Nm - corners[-1][1]) / (4.0 * peak_Nm), to_Nm))

        for factor in factors:
            for to_Nm in (peak_Nm, -peak_Nm):
                go(to_Nm, factor)
                if hold_s:
                    corners.append((corners[-1][0] + hold_s, to_Nm))
        go(peak_Nm if rng.random() < 0.4 else 0.0, factors[-1])
        count = int(10.0 ** rng.uniform(3.0, 4.0))
        if "other_rate" in nuisances:
            count = int(rng.integers(300, 800))
        self.time_s = numpy.linspace(0.0, corners[-1][0], count)
        self.fine_s = numpy.linspace(0.0, corners[-1][0], SUBSTEPS * (count - 1) + 1)
        corner_s, corner_Nm = numpy.array(corners).T
        self.reversals = numpy.unique(numpy.searchsorted(self.fine_s, corner_s).clip(0, len(self.fine_s) - 1))
        # The profile passes through the grid points that stand for the corners, so that no branch overshoots its peak.
        corner_s = self.fine_s[self.reversals] if len(self.reversals) == len(corner_s) else corner_s
        self.fine_Nm = numpy.interp(self.fine_s, corner_s, corner_Nm)
        if smooth:
            index = numpy.searchsorted(corner_s, self.fine_s, side="right").clip(1, len(corner_s) - 1) - 1
            share = ((self.fine_s - corner_s[index]) / numpy.diff(corner_s)[index]).clip(0.0, 1.0)
            self.fine_Nm = corner_Nm[index] + numpy.diff(corner_Nm)[index] * 0.5 * (1.0 - numpy.cos(math.pi * share))
        self.held = hold_s > 0.0

    def _round_knees(self, rng):
        """Knees may be round, but only so far that the roundness itself stays below one sigma."""
        self._columns = None
        sharp = self.respond([])
        wanted = rng.uniform(0.0, 0.02)
        ruler = Ruler(self.regressors(), self.noise_sd, self.rho)
        for _ in range(12):
            self.loop.rounding = wanted
            if ruler.sigma(self.respond([]) - sharp) < 1.0:
                break
            wanted *= 0.6
        self._columns = None

    def _draw_surroundings(self, rng, wants, nuisances):
        bare = "missing_columns" in nuisances
        self.has_temperature = not bare and rng.random() < (0.5 if "thermal_drift" in wants else 0.35)
        share = self.fine_s / self.fine_s[-1]
        self.fine_degC = (rng.uniform(18.0, 28.0) + rng.uniform(0.5, 4.0) *
                          (1.0 - numpy.exp(-share / rng.uniform(0.2, 1.0))) +
                          rng.uniform(0.1, 0.5) * numpy.sin(2.0 * math.pi * (rng.uniform(0.3, 1.2) * share + rng.random())))

    def nominal_parameters(self):
        return {"k1": (self.loop.k1_Nm_per_rad, "Nm/rad"), "k2": (self.loop.k2_Nm_per_rad, "Nm/rad"),
                "k3": (self.loop.k3_Nm_per_rad, "Nm/rad"), "friction_torque": (self.loop.friction_Nm, "Nm"),
                "yield_twist": (self.loop.yield_rad * ARCMIN, "arcmin"), "rounding": (self.loop.rounding, "")}

    def sample_count(self):
        return len(self.time_s)

    def _twist_arcmin(self, loop):
        return loop.twist_rad(self.fine_s, self.fine_Nm, self.reversals)[::SUBSTEPS] * ARCMIN

    def respond(self, effects):
        loop = self.loop
        for effect, scale in effects:
            loop = effect.act(loop, scale)
        return self._twist_arcmin(loop)[numpy.newaxis, :]

    def regressors(self):
        """The nominal parameters' directions, by central differences, and a constant: the angle's zero is arbitrary."""
        if self._columns is None:
            columns = [numpy.ones(len(self.time_s))]
            for name in ("k1_Nm_per_rad", "k2_Nm_per_rad", "k3_Nm_per_rad", "friction_Nm", "yield_rad"):
                value = getattr(self.loop, name)
                above, below = (dataclasses.replace(self.loop, **{name: value * factor}) for factor in (1.003, 0.997))
                columns.append((self._twist_arcmin(above) - self._twist_arcmin(below)) / 0.006)
            self._columns = numpy.stack(columns, axis=1)
        return self._columns

    def record(self, measured, keep, rng, quantise):
        noise_Nm = rng.normal(0.0, 1.0, len(self.time_s)) * self.torque_sd_Nm
        angle_arcmin = (measured[0] - measured[0][keep][0])[keep]
        if quantise:
            angle_arcmin = quantise * numpy.round(angle_arcmin / quantise)
        columns = {"time_s": (self.time_s[keep], "%.6f"),
                   "torque_Nm": ((self.fine_Nm[::SUBSTEPS] + noise_Nm)[keep], "%.5f"),
                   "output_angle_deg": (angle_arcmin / 60.0, "%.9f")}
        if self.has_temperature:
            measured_degC = self.fine_degC[::SUBSTEPS] + rng.normal(0.0, 0.02, len(self.time_s))
            columns["temperature_degC"] = (measured_degC[keep], "%.2f")
        t1_Nm, t2_Nm, t3_Nm = self.stated_Nm
        return {"kind": self.kind, "t1_Nm": "%g" % t1_Nm, "t2_Nm": "%g" % t2_Nm, "t3_Nm": "%g" % t3_Nm}, columns

    def response_noise_sd(self):
        """White angle noise to add: the torque's noise enters through the torque column."""
        return self.angle_sd_arcmin

    def make_effect(self, name, rng):
        return hysteresis_effect(self, name, rng)

    def make_outside(self, rng):
        return outside_effect(self, rng)


def _series(name, function, describe, first, most, signature=None):
    """A twist in series with the loop: `function(time_s, torque_Nm)` in arcmin at scale 1."""
    def act(loop, scale):
        return dataclasses.replace(loop, after=loop.after + (lambda t, torque: scale * function(t, torque) / ARCMIN,))
    return Effect(name, act, describe, first, most, signature)


def _changed(name, change, describe, first, most, signature=None):
    def act(loop, scale):
        return dataclasses.replace(loop, **change(loop, scale))
    return Effect(name, act, describe, first, most, signature)


def hysteresis_effect(experiment, name, rng):
    sign = rng.choice([-1.0, 1.0])
    peak_Nm = experiment.limits_Nm[2]
    if name == "backlash":
        # Teeth that part: the gap is in series with everything else, and is crossed while hardly any torque passes.
        half_Nm = rng.uniform(0.05, 0.3)
        return _series(name, lambda t, torque: 0.5 * numpy.tanh(torque / half_Nm),
                       lambda scale: {"width": (scale, "arcmin")}, 0.05, 3.0)
    if name == "asymmetric_stiffness":
        return _changed(name, lambda loop, scale: {"positive_gain": 1.0 + 0.5 * sign * scale,
                                                   "negative_gain": 1.0 - 0.5 * sign * scale},
                        lambda scale: {"asymmetry": (sign * scale, "")}, 0.01, 0.6)
    if name == "cubic_hardening":
        return _changed(name, lambda loop, scale: {"cubic_Nm_per_rad3": scale},
                        lambda scale: {"cubic": (scale, "Nm/rad^3")}, 1e8, 2e10)
    if name == "creep":
        span_s = experiment.fine_s[-1]
        if rng.random() < 0.5:
            taus_s = [span_s * rng.uniform(0.03, 0.12)]
        else:  # a logarithmic law is a spectrum of lags, one every factor of three
            taus_s = [0.004 * span_s * 3.0 ** k for k in range(6)]

        def flow(t, torque):
            return sum(lag(t, torque, tau_s) for tau_s in taus_s) / len(taus_s) / experiment.loop.k2_Nm_per_rad * ARCMIN
        truth = (lambda scale: {"time_constant": (taus_s[0], "s")}) if len(taus_s) == 1 else (lambda scale: {})
        return _series(name, flow, truth, 0.01, 0.3)
    if name == "brake_slip":
        level_Nm = peak_Nm * rng.uniform(0.55, 0.88)
        both = rng.random() < 0.3
        step_s = experiment.fine_s[1]

        def slipped(t, torque):
            beyond = numpy.maximum(sign * torque - level_Nm, 0.0) * sign
            if both:
                beyond = beyond + numpy.maximum(-sign * torque - level_Nm, 0.0) * -sign
            return numpy.cumsum(beyond) * step_s / (peak_Nm * t[-1])
        return _series(name, slipped, lambda scale: {"level": (level_Nm, "Nm")}, 10.0, 500.0)
    if name == "thermal_drift":
        share = experiment.fine_s / experiment.fine_s[-1]
        if experiment.has_temperature:
            shape = sign * (experiment.fine_degC - experiment.fine_degC[0])
            return _series(name, lambda t, torque: shape, lambda scale: {"drift": (sign * scale, "arcmin/K")}, 0.1, 3.0)
        shape = sign * (share if rng.random() < 0.5 else 1.0 - numpy.exp(-share / rng.uniform(0.3, 1.0)))
        return _series(name, lambda t, torque: shape, lambda scale: {"total": (scale * shape[-1], "arcmin")}, 0.1, 3.0)
    if name == "torque_zero_offset":
        return _changed(name, lambda loop, scale: {"torque_zero_Nm": sign * scale},
                        lambda scale: {"offset": (sign * scale, "Nm")}, 0.1, 4.0)
    if name == "distributed_friction":
        yields = tuple(numpy.exp(rng.uniform(-1.2, -0.6) + numpy.linspace(0.0, rng.uniform(2.4, 3.2), 9)))
        return _changed(name, lambda loop, scale: {"spread_share": scale, "spread_yields": yields},
                        lambda scale: {}, 0.2, 1.0)
    return _changed("rate_dependence", lambda loop, scale: {"viscous_Nm_s_per_rad": scale},
                    lambda scale: {"viscous": (scale, "Nm*s/rad")}, 300.0, 3e4)


def outside_effect(experiment, rng):
    span_s = experiment.fine_s[-1]
    which = rng.choice(["shift_in_window", "oscillation_in_time", "ripple_in_twist", "bump_at_a_torque", "shelf_at_a_torque"],
                       p=[0.25, 0.25, 0.15, 0.2, 0.15])
    amplitude = lambda scale: {"amplitude": (scale, "arcmin")}
    if which == "shift_in_window":
        start_s = rng.uniform(0.15, 0.7) * span_s
        end_s = start_s + rng.uniform(0.06, 0.2) * span_s
        soft_s = 0.002 * span_s
        box = lambda t, torque: 0.5 * (numpy.tanh((t - start_s) / soft_s) - numpy.tanh((t - end_s) / soft_s))
        return _series(which, box, amplitude, 0.1, 2.0,
                       {"what": "window", "regressor": "time", "window": [start_s, end_s], "values": [], "tolerance": 0.0,
                        "unit": "s"})
    if which == "oscillation_in_time":
        sample_hz = len(experiment.time_s) / span_s
        frequency_hz = 10.0 ** rng.uniform(math.log10(25.0 / span_s), math.log10(0.2 * sample_hz))
        phase = rng.uniform(-math.pi, math.pi)
        return _series(which, lambda t, torque: numpy.sin(2.0 * math.pi * frequency_hz * t + phase), amplitude, 0.05, 2.0,
                       {"what": "order", "regressor": "time",
                        "values": [frequency_hz, 1.0 / frequency_hz, 2.0 * math.pi * frequency_hz],
                        "tolerance": max(0.02 * frequency_hz, 0.5 / span_s) / frequency_hz, "relative": True})
    if which.endswith("at_a_torque"):
        peak_Nm = experiment.limits_Nm[2]
        level_Nm = rng.choice([-1.0, 1.0]) * rng.uniform(0.25, 0.8) * peak_Nm
        width_Nm = rng.uniform(0.04, 0.12) * peak_Nm
        if which == "bump_at_a_torque":
            return _series(which, lambda t, torque: 1.0 / numpy.cosh(2.0 * (torque - level_Nm) / width_Nm) ** 2, amplitude, 0.02, 2.0,
                           {"what": "window", "regressor": "torque", "values": [], "tolerance": 0.0, "unit": "Nm",
                            "window": [level_Nm - 0.45 * width_Nm, level_Nm + 0.45 * width_Nm]})
        return _series(which, lambda t, torque: numpy.arctan(10.0 * (torque - level_Nm) / width_Nm), amplitude, 0.02, 2.0,
                       {"what": "place", "regressor": "torque", "values": [level_Nm], "tolerance": 0.05 * peak_Nm, "unit": "Nm"})
    period_rad = rng.uniform(0.8, 1.8) / ARCMIN
    phase = rng.uniform(-math.pi, math.pi)
    return _changed(which, lambda loop, scale: {"ripple_Nm": scale, "ripple_period_rad": period_rad,
                                                "ripple_phase_rad": phase},
                    lambda scale: {"amplitude": (scale, "Nm")}, 0.05, 1.5,
                    {"what": "order", "regressor": "angle", "relative": True, "tolerance": 0.08,
                     "values": [period_rad * ARCMIN, period_rad, period_rad * 180.0 / math.pi, 2.0 * math.pi / period_rad,
                                1.0 / period_rad, 1.0 / (period_rad * ARCMIN)]})
