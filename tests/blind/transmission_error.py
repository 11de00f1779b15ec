# SPDX-License-Identifier: Apache-2.0
"""Transmission error: stepped or continuous sweeps of a reducer whose error is made of angle, direction, load and time."""
import math

import numpy

from effect import Effect

CAUSES = ("wave_generator_first_harmonic", "wave_generator_fourth_harmonic", "output_eccentricity",
          "circular_spline_ovality", "backlash", "thermal_drift", "local_tooth_damage", "load_windup")
MOST_ARCMIN = 3.0


class TransmissionError:
    kind = "transmission_error"
    unit = "arcmin"

    def __init__(self, rng, wants, nuisances, wrong_number=False):
        self.rho = rng.uniform(0.3, 0.8) if "coloured_noise" in nuisances else 0.0
        self.noise_sd = 10.0 ** rng.uniform(-2.0, -1.3)
        self.ratio = float(rng.choice([80.0, 50.0, 100.0, -80.0], p=[0.76, 0.1, 0.1, 0.04]))
        self.second_arcmin = rng.uniform(1.2, 3.0) if wrong_number else rng.uniform(0.2, 1.0)
        self.second_phase_rad = rng.uniform(-math.pi, math.pi)
        self.offset_arcmin = rng.uniform(-2.0, 2.0)
        self._draw_sweep(rng, wants, nuisances)
        self._draw_surroundings(rng, wants, nuisances)

    def _draw_sweep(self, rng, wants, nuisances):
        unusual = "other_rate" in nuisances
        self.step_deg = float(rng.choice([0.5, 0.7, 2.0])) if unusual else 1.0
        self.continuous = not unusual and rng.random() < 0.15
        short = "short_record" in nuisances
        both = "backlash" in wants or rng.random() < (0.5 if short else 0.8)
        turns = 1 if short else int(rng.choice([1, 2, 3], p=[0.65, 0.25, 0.1]))
        if self.continuous:
            count = int(turns * rng.integers(600, 1500))
            # A real drive does not turn evenly: a slow wander of a fraction of a degree.
            share = numpy.arange(count) / count
            wander_deg = 0.3 * numpy.sin(2.0 * math.pi * (rng.uniform(1.0, 5.0) * share + rng.random()))
            sweep_deg = 360.0 * turns * share + wander_deg
            seconds_a_sample = rng.uniform(20.0, 60.0) / (count / turns)
        else:
            count = int(math.floor(360.0 * turns / self.step_deg + 1e-9))
            sweep_deg = self.step_deg * numpy.arange(count)
            seconds_a_sample = rng.uniform(0.3, 2.0)
        parts = [(1.0, sweep_deg)] + ([(-1.0, sweep_deg[::-1])] if both else [])
        self.sense = numpy.concatenate([numpy.full(len(part), sign) for sign, part in parts])
        self.target_deg = numpy.concatenate([part for _, part in parts])
        self.time_s = seconds_a_sample * numpy.arange(len(self.sense)) + (self.sense < 0) * rng.uniform(0.5, 5.0)
        # The motor stops a little off each step, more so in the direction it comes from.
        following_deg = rng.uniform(0.2, 2.0)
        error_deg = following_deg * (0.4 * rng.standard_normal(len(self.sense)) - 0.5 * self.sense)
        self.input_deg = self.ratio * self.target_deg + math.copysign(1.0, self.ratio) * error_deg
        self.input_rad = numpy.radians(self.input_deg)
        self.output_rad = self.input_rad / self.ratio

    def _draw_surroundings(self, rng, wants, nuisances):
        bare = "missing_columns" in nuisances
        drift = "thermal_drift" in wants
        self.has_temperature = (rng.random() < 0.5) if drift else (not bare and rng.random() < 0.4)
        self.has_time = (drift and not self.has_temperature) or self.continuous or (not bare and rng.random() < 0.75)
        self.has_torque = "load_windup" in wants or (not bare and rng.random() < 0.4)
        share = self.time_s / self.time_s[-1]
        warming = rng.uniform(2.0, 8.0) * (1.0 - numpy.exp(-share / rng.uniform(0.2, 0.8)))
        room = rng.uniform(0.3, 1.5) * numpy.sin(2.0 * math.pi * (rng.uniform(0.3, 1.7) * share + rng.random()))
        self.temperature_degC = rng.uniform(18.0, 28.0) + warming + room
        # The load goes its own way: levels that the load motor holds for a while, and a slow wave.
        edges = numpy.sort(rng.uniform(0.0, 1.0, 7))
        levels_Nm = rng.uniform(-12.0, 12.0, 8)
        softness = 0.004
        torque_Nm = numpy.full(len(share), levels_Nm[0])
        for edge, step_Nm in zip(edges, numpy.diff(levels_Nm)):
            torque_Nm += step_Nm / (1.0 + numpy.exp(-numpy.clip((share - edge) / softness, -60.0, 60.0)))
        wave = numpy.sin(2.0 * math.pi * (rng.uniform(2.3, 6.7) * share + rng.random()))
        self.torque_Nm = torque_Nm + rng.uniform(0.3, 2.0) * wave

    def nominal_parameters(self):
        return {"second_harmonic_amplitude": (self.second_arcmin, "arcmin"), "ratio": (self.ratio, "")}

    def sample_count(self):
        return len(self.input_rad)

    def regressors(self):
        angle = 2.0 * self.input_rad
        return numpy.stack([numpy.ones_like(angle), numpy.cos(angle), numpy.sin(angle)], axis=1)

    def respond(self, effects):
        response = self.offset_arcmin + self.second_arcmin * numpy.sin(2.0 * self.input_rad + self.second_phase_rad)
        for effect, scale in effects:
            response = response + effect.act(scale)
        return response[numpy.newaxis, :]

    def _harmonic(self, name, angle_rad, rng, order, signature=None):
        shape = numpy.sin(order * angle_rad + rng.uniform(-math.pi, math.pi))
        return self._shaped(name, shape, lambda scale: {"amplitude": (scale, "arcmin")}, signature)

    def _shaped(self, name, shape, describe, signature=None):
        peak = max(float(numpy.max(numpy.abs(shape))), 1e-12)
        return Effect(name, lambda scale: scale * shape, describe, 0.1 / peak, MOST_ARCMIN / peak, signature)

    def _off_centre_deg(self, centre_deg):
        return (numpy.degrees(self.output_rad) - centre_deg + 180.0) % 360.0 - 180.0

    def make_effect(self, name, rng):
        if name == "wave_generator_first_harmonic":
            return self._harmonic(name, self.input_rad, rng, 1.0)
        if name == "wave_generator_fourth_harmonic":
            return self._harmonic(name, self.input_rad, rng, 4.0)
        if name == "output_eccentricity":
            return self._harmonic(name, self.output_rad, rng, 1.0)
        if name == "circular_spline_ovality":
            return self._harmonic(name, self.output_rad, rng, 2.0)
        if name == "backlash":
            return self._shaped(name, 0.5 * self.sense, lambda scale: {"width": (scale, "arcmin")})
        if name == "load_windup":
            sign = rng.choice([-1.0, 1.0], p=[0.15, 0.85])
            return self._shaped(name, sign * self.torque_Nm, lambda scale: {"windup": (sign * scale, "arcmin/Nm")})
        if name == "thermal_drift":
            return self._drift(rng)
        # local_tooth_damage: a bump of a few degrees, round or steeper on one flank.
        centre_deg, width_deg = rng.uniform(15.0, 345.0), rng.uniform(max(1.2, 0.9 * self.step_deg), 3.0)
        off_deg, skew = self._off_centre_deg(centre_deg), rng.uniform(0.7, 1.4)
        sign = rng.choice([-1.0, 1.0])
        shape = sign * numpy.exp(-0.5 * (off_deg / numpy.where(off_deg > 0.0, skew, 1.0) / width_deg) ** 2)
        return self._shaped(name, shape, lambda scale: {"height": (sign * scale, "arcmin"), "centre": (centre_deg, "deg"),
                                                        "width_sd": (width_deg, "deg")})

    def _drift(self, rng):
        sign = rng.choice([-1.0, 1.0])
        if self.has_temperature:
            shape = sign * (self.temperature_degC - self.temperature_degC[0])
            return self._shaped("thermal_drift", shape, lambda scale: {"drift": (sign * scale, "arcmin/K")})
        share = self.time_s / self.time_s[-1]
        if rng.random() < 0.5:
            shape = sign * share
        else:
            shape = sign * (1.0 - numpy.exp(-share / rng.uniform(0.3, 1.0)))
        return self._shaped("thermal_drift", shape, lambda scale: {"total": (scale * shape[-1], "arcmin")})

    def make_outside(self, rng):
        which = rng.choice(["output_order", "third_of_input", "window_ripple"])
        if which == "output_order":
            order = float(rng.choice([3.0, 5.0, 7.0]))
            return self._harmonic("order_of_output", self.output_rad, rng, order,
                                  {"what": "order", "regressor": "output_angle", "values": [order], "tolerance": 0.15})
        if which == "third_of_input":
            a_turn = abs(3.0 * self.ratio)
            values = [3.0, a_turn]
            if not self.continuous:  # a stepped sweep cannot tell an order from its fold, so the fold is right too
                per_turn = 360.0 / self.step_deg
                fold = abs(a_turn - per_turn * round(a_turn / per_turn))
                values += [fold, per_turn - fold, fold / abs(self.ratio)]
            return self._harmonic("third_harmonic_of_input", self.input_rad, rng, 3.0,
                                  {"what": "order", "regressor": "input_angle", "values": values, "tolerance": 0.03})
        centre_deg, half_deg, order = rng.uniform(50.0, 310.0), rng.uniform(15.0, 30.0), rng.integers(14, 30)
        off_deg = self._off_centre_deg(centre_deg)
        shape = numpy.where(numpy.abs(off_deg) < half_deg, numpy.cos(0.5 * math.pi * off_deg / half_deg), 0.0)
        shape = shape * numpy.sin(order * self.output_rad + rng.uniform(-math.pi, math.pi))
        window = [centre_deg - half_deg, centre_deg + half_deg]
        return self._shaped("ripple_in_window", shape, lambda scale: {"amplitude": (scale, "arcmin")},
                            {"what": "window", "regressor": "output_angle", "window": window, "values": [float(order)],
                             "tolerance": 0.6, "unit": "deg"})

    def record(self, measured, keep, rng, quantise):
        """Metadata and columns of the record, from the measured response with its noise."""
        error_arcmin = measured[0]
        output_deg = self.input_deg / self.ratio - error_arcmin / 60.0
        columns = {"direction": [("cw" if sense > 0 else "ccw") for sense in self.sense[keep]]}
        if self.has_time:
            columns["time_s"] = (self.time_s[keep], "%.4f")
        # Both angles are zeroed at the first sample of the record (docs/contract.md#transmission-error).
        columns["input_angle_deg"] = ((self.input_deg - self.input_deg[keep][0])[keep], "%.6f")
        zeroed_deg = (output_deg - output_deg[keep][0])[keep]
        if quantise:
            zeroed_deg = quantise * numpy.round(zeroed_deg * 60.0 / quantise) / 60.0
        columns["output_angle_deg"] = (zeroed_deg, "%.8f")
        if self.has_torque:
            columns["torque_Nm"] = ((self.torque_Nm + rng.normal(0.0, 0.02, len(self.torque_Nm)))[keep], "%.4f")
        if self.has_temperature:
            columns["temperature_degC"] = ((self.temperature_degC + rng.normal(0.0, 0.03, len(self.time_s)))[keep], "%.2f")
        return {"kind": self.kind, "ratio": "%g" % self.ratio}, columns
