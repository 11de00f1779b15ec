# SPDX-License-Identifier: Apache-2.0
"""Transmission error, what two benches share: effects by several laws for each name, records, the nominal second harmonic.

A bench gives the angle of the input, the sense of turning, the time, torque and temperature of each sample. Laws are functions
of these; eccentric parts follow the exact triangle and not its first term, so they carry the harmonics that it carries.
"""
import math

import numpy

from .model import Effect, Model, pick
from .noise import draw_noise

CAUSES = ("wave_generator_first_harmonic", "wave_generator_fourth_harmonic", "output_eccentricity", "circular_spline_ovality",
          "backlash", "thermal_drift", "local_tooth_damage", "load_windup")
NOT_COLOURED = ("thermal_drift", "output_eccentricity", "circular_spline_ovality")
MOST_ARCMIN = 3.0


def eccentric(angle_rad, share):
    """atan2(e sin, 1 + e cos) / e: what a disc that is off its centre by `share` of its radius reads wrong."""
    return numpy.arctan2(share * numpy.sin(angle_rad), 1.0 + share * numpy.cos(angle_rad)) / share


def ellipse(angle_rad, share):
    """Polar angle of an ellipse less its parameter, over its largest: the second harmonic with the fourth that belongs to it."""
    parameter = numpy.arctan2((1.0 - share) * numpy.sin(angle_rad), numpy.cos(angle_rad))
    difference = (parameter - angle_rad + math.pi) % (2.0 * math.pi) - math.pi
    return difference / numpy.max(numpy.abs(difference))


class Gear(Model):
    kind, unit, causes = "transmission_error", "arcmin", CAUSES
    rivals = CAUSES[:6] + ("load_windup",)

    def __init__(self, rng, wants, wrong_number=False):
        self.possible = True
        self.nuisances = []
        self.ratio = float(rng.choice([80.0, 100.0, 50.0, -80.0, 120.0], p=[0.5, 0.15, 0.15, 0.1, 0.1]))
        self.second_arcmin = rng.uniform(1.2, 3.0) if wrong_number else rng.uniform(0.15, 0.9)
        self.second_phase_rad, self.offset_arcmin = rng.uniform(-math.pi, math.pi), rng.uniform(-2.0, 2.0)
        self.draw_bench(rng, wants)
        self.input_rad = numpy.radians(self.input_deg)
        self.output_rad = self.input_rad / self.ratio
        coloured = not any(name in NOT_COLOURED for name in wants) and rng.random() < 0.15
        self.nuisances += ["coloured_noise"] * coloured
        sd_arcmin = 10.0 ** rng.uniform(-2.0, -1.3)
        self.quantum = sd_arcmin * rng.uniform(0.3, 1.5) if rng.random() < 0.4 else 0.0
        self.nuisances += ["quantisation"] * bool(self.quantum)
        self.added = draw_noise(rng, sd_arcmin, coloured)
        total = draw_noise(rng, math.hypot(sd_arcmin, self.quantum / math.sqrt(12.0)), False)
        total.a1, total.a2, total.tails = self.added.a1, self.added.a2, self.added.tails
        self.noise = total
        self.held_share = rng.uniform(0.001, 0.005) if rng.random() < 0.2 else 0.0
        self.nuisances += ["held_samples"] * bool(self.held_share)

    def residual(self, effects):
        return sum((effect.act(scale) for effect, scale in effects), numpy.zeros_like(self.input_rad))[numpy.newaxis, :]

    def regressors(self):
        angle = 2.0 * self.input_rad
        return numpy.stack([numpy.ones_like(angle), numpy.cos(angle), numpy.sin(angle)], axis=1)

    def nominal_parameters(self):
        return {"second_harmonic_amplitude": (self.second_arcmin, "arcmin"), "ratio": (self.ratio, "")}

    def _shaped(self, name, law, shape, describe=lambda scale: {}, signature=None):
        peak = max(float(numpy.max(numpy.abs(shape))), 1e-12)
        return Effect(name, law, lambda scale: scale * shape, describe, 0.05 / peak, MOST_ARCMIN / peak, signature)

    def _off_centre_deg(self, centre_deg):
        return (numpy.degrees(self.output_rad) - centre_deg + 180.0) % 360.0 - 180.0

    def make_effect(self, name, rng):
        phase = rng.uniform(-math.pi, math.pi)
        amplitude = lambda scale: {"amplitude": (scale, "arcmin")}
        if name in ("wave_generator_first_harmonic", "output_eccentricity"):
            angle = (self.input_rad if name.startswith("wave") else self.output_rad) + phase
            law = pick(rng, "eccentric_disc", "two_discs", "line_that_grows_with_load")
            if law == "eccentric_disc":
                return self._shaped(name, law, eccentric(angle, rng.uniform(0.005, 0.03)), amplitude)
            if law == "two_discs":  # scale and coupling, a quarter of a turn apart or so, add up to one line
                shape = eccentric(angle, 0.01) + rng.uniform(0.2, 0.5) * eccentric(angle + rng.uniform(0.8, 1.8), 0.02)
                return self._shaped(name, law, shape)
            load = self.torque_Nm / max(float(numpy.max(numpy.abs(self.torque_Nm))), 1e-9)
            return self._shaped(name, law, numpy.sin(angle) * (1.0 + 0.1 * load))
        if name == "wave_generator_fourth_harmonic":
            law, angle = pick(rng, "cam", "cam_with_a_bearing", "line_that_wanders"), 4.0 * self.input_rad + phase
            if law == "cam":
                return self._shaped(name, law, numpy.sin(angle), amplitude)
            if law == "cam_with_a_bearing":
                return self._shaped(name, law, numpy.sin(angle + 0.08 * numpy.sin(2.0 * self.input_rad)))
            return self._shaped(name, law, numpy.sin(angle) * (1.0 + 0.12 * numpy.sin(self.output_rad + 2.0 * phase)))
        if name == "circular_spline_ovality":
            law, share = pick(rng, "ellipse", "clamped_ring", "sine"), rng.uniform(0.01, 0.03)
            shape = {"ellipse": lambda: ellipse(self.output_rad + phase, share), "sine": lambda: numpy.sin(2.0 * self.output_rad + phase),
                     "clamped_ring": lambda: numpy.sin(2.0 * self.output_rad + phase) + 0.05 * numpy.sin(4.0 * self.output_rad - phase)}[law]()
            return self._shaped(name, law, shape, amplitude if law == "sine" else lambda scale: {})
        if name == "backlash":
            return self._backlash(rng)
        if name == "load_windup":
            law, sign = pick(rng, "soft_at_low_torque", "with_hysteresis", "cubic"), float(rng.choice([-1.0, 1.0], p=[0.15, 0.85]))
            torque, most = self.torque_Nm, float(numpy.max(numpy.abs(self.torque_Nm)))
            if law == "soft_at_low_torque":
                shape = torque + 0.12 * most * numpy.tanh(torque / (0.25 * most))
            elif law == "cubic":
                shape = torque * (1.0 - 0.1 * (torque / most) ** 2)
            else:  # the friction of the teeth holds some of it back
                shape = play(torque, 0.03 * most)
            return self._shaped(name, law, sign * shape)
        return self._drift(rng) if name == "thermal_drift" else self._damage(rng)

    def _backlash(self, rng):
        if not numpy.ptp(self.sense):
            return None
        law = pick(rng, "taken_up_over_some_degrees", "less_under_load", "wider_on_one_side")
        side = 0.5 * self.sense
        if law == "taken_up_over_some_degrees":
            # After each reversal the contact moves over to the other flank within some degrees of the output.
            half_deg = rng.uniform(0.2, 1.0)
            side = 0.5 * play(numpy.degrees(self.output_rad) * math.copysign(1.0, self.ratio), half_deg, only_lag=True) / half_deg
            side = side * numpy.sign(float((side * self.sense).sum()))
        elif law == "less_under_load":
            side = side * (1.0 - 0.2 * numpy.abs(self.torque_Nm) / max(float(numpy.max(numpy.abs(self.torque_Nm))), 1e-9))
        else:
            side = side * (1.0 + 0.15 * numpy.sin(self.output_rad + rng.uniform(0.0, 6.0)))
        return self._shaped("backlash", law, side, lambda scale: {"width": (scale, "arcmin")} if law.startswith("taken") else {})

    def _drift(self, rng):
        law, sign = pick(rng, "two_time_constants", "lags_behind_the_sensor", "logarithm"), float(rng.choice([-1.0, 1.0]))
        share = (self.time_s - self.time_s[0]) / (self.time_s[-1] - self.time_s[0])
        if self.has_temperature:
            course, tau = self.temperature_degC - self.temperature_degC[0], rng.uniform(0.01, 0.04)
            if law == "two_time_constants":
                shape = course + 0.1 * numpy.ptp(course) * (1.0 - numpy.exp(-share / 0.2))
            elif law == "lags_behind_the_sensor":
                shape = numpy.array(course)
                steps = 1.0 - numpy.exp(-numpy.diff(share) / tau)
                for k, part in enumerate(steps, 1):
                    shape[k] = shape[k - 1] + part * (course[k] - shape[k - 1])
            else:
                shape = course * (1.0 - 0.1 * course / (numpy.ptp(course) + 1e-9))
            return self._shaped("thermal_drift", law, sign * shape)
        tau = rng.uniform(0.1, 0.4)
        shape = {"two_time_constants": lambda: 0.7 * (1.0 - numpy.exp(-share / tau)) + 0.3 * (1.0 - numpy.exp(-share / 1.5)),
                 "lags_behind_the_sensor": lambda: 1.0 - (1.0 + share / tau) * numpy.exp(-share / tau),
                 "logarithm": lambda: numpy.log1p(share / tau)}[law]()
        return self._shaped("thermal_drift", law, sign * shape)

    def _damage(self, rng):
        law, centre_deg = pick(rng, "raised_cosine", "wedge", "one_flank"), rng.uniform(20.0, 340.0)
        off_deg, width_deg = self._off_centre_deg(centre_deg), rng.uniform(max(2.0, 2.0 * self.spacing_deg), 5.0)
        shape = {"raised_cosine": lambda: 0.5 * (1.0 + numpy.cos(math.pi * (off_deg / width_deg).clip(-1.0, 1.0))),
                 "wedge": lambda: (1.0 - numpy.abs(off_deg) / width_deg).clip(0.0),
                 # Felt by the flank that is in contact when it turns this way.
                 "one_flank": lambda: numpy.exp(-numpy.abs(off_deg / (0.6 * width_deg)) ** 3) * (self.sense > 0)}[law]()
        return self._shaped("local_tooth_damage", law, float(rng.choice([-1.0, 1.0])) * shape,
                            lambda scale: {"centre": (centre_deg, "deg")})

    def make_outside(self, rng):
        law, phase = pick(rng, "order_of_output", "beat_in_a_sector", "seam"), rng.uniform(-math.pi, math.pi)
        if law == "order_of_output":
            order = float(rng.choice([3.0, 4.0, 6.0, 9.0]))
            return self._shaped(law, law, numpy.sin(order * self.output_rad + phase),
                                signature={"what": "order", "regressor": "output_angle", "values": [order], "tolerance": 0.15})
        centre_deg = rng.uniform(60.0, 300.0)
        off_deg = self._off_centre_deg(centre_deg)
        if law == "beat_in_a_sector":
            half_deg, order = rng.uniform(25.0, 45.0), int(rng.integers(11, 24))
            shape = numpy.exp(-0.5 * (2.0 * off_deg / half_deg) ** 2) * numpy.sin(order * self.output_rad + phase)
            return self._shaped(law, law, shape, signature={"what": "window", "regressor": "output_angle", "unit": "deg", "tolerance": 0.6,
                                                            "window": [centre_deg - half_deg, centre_deg + half_deg], "values": [float(order)]})
        half_deg = rng.uniform(15.0, 35.0)  # a scale that was mended: a sector of it sits off by a constant
        shape = 0.5 * (numpy.tanh((off_deg + half_deg) / 2.0) - numpy.tanh((off_deg - half_deg) / 2.0))
        return self._shaped(law, law, shape, signature={"what": "window", "regressor": "output_angle", "unit": "deg", "tolerance": 0.0,
                                                        "window": [centre_deg - half_deg, centre_deg + half_deg], "values": []})

    def record(self, effects, rng):
        error_arcmin = self.offset_arcmin + self.second_arcmin * numpy.sin(2.0 * self.input_rad + self.second_phase_rad)
        error_arcmin = error_arcmin + self.residual(effects)[0] + self.added.draw(rng, (1, len(self.input_rad)))[0]
        output_deg = self.input_deg / self.ratio - error_arcmin / 60.0
        input_deg = self.input_deg - self.input_deg[0]
        if self.quantum:
            output_deg = self.quantum / 60.0 * numpy.round(output_deg * 60.0 / self.quantum)
        columns = {"direction": ["cw" if sense > 0 else "ccw" for sense in self.sense]}
        if self.has_time:
            columns["time_s"] = (self.time_s, "%.5f")
        columns["input_angle_deg"] = (input_deg, "%.6f")
        columns["output_angle_deg"] = (output_deg - output_deg[0], "%.8f")
        if self.has_torque:
            torque_Nm = self.torque_Nm + rng.normal(0.0, 0.02, len(self.time_s))
            if self.held_share:
                for at in 1 + rng.choice(len(torque_Nm) - 1, max(int(self.held_share * len(torque_Nm)), 1), replace=False):
                    torque_Nm[at] = torque_Nm[at - 1]
            columns["torque_Nm"] = (torque_Nm, "%.4f")
        if self.has_temperature:
            columns["temperature_degC"] = (self.temperature_degC + rng.normal(0.0, 0.03, len(self.time_s)), "%.2f")
        return {"kind": self.kind, "ratio": "%g" % self.ratio}, columns


def play(values, half, only_lag=False):
    """The play operator: follows at a distance of at most `half`; `only_lag`: how far it is behind, by which side."""
    out, at = [], float(values[0])
    for value in values.tolist():
        at = min(max(at, value - half), value + half)
        out.append(value - at if only_lag else at)
    return numpy.array(out)
