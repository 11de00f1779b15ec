# SPDX-License-Identifier: Apache-2.0
"""Motion records: the torque that an axis needs to follow a motion, by inverse dynamics; inertias behind backlash take substeps.

A stiff position loop makes the motion; what hides in the axis shows in the torque. All terms are functions of time, so a torque
that acts late is the same sum read at a later time.
"""
import math

import numpy

from effect import Effect
from backlash_load import backlash_reaction, resonance_reaction
from trajectory import draw_trajectory

CAUSES = ("stribeck_friction", "asymmetric_friction", "position_periodic_torque", "gravity_load", "quadratic_drag",
          "load_dependent_friction", "thermal_friction_drift", "torsional_resonance", "backlash", "time_delay",
          "external_disturbance")
NEED_TURNING = ("position_periodic_torque", "gravity_load")


class Motion:
    kind = "motion"

    def __init__(self, rng, wants, nuisances, wrong_number=False):
        self.rho = rng.uniform(0.3, 0.8) if "coloured_noise" in nuisances else 0.0
        self.linear = not any(name in wants for name in NEED_TURNING) and rng.random() < 0.15
        self.unit = "N" if self.linear else "Nm"
        self._draw_sampling(rng, nuisances)
        self._at_samples = None
        # Angles in rad or metres; a turning axis goes over one to several turns at most.
        travel = rng.uniform(0.05, 0.5) if self.linear else 10.0 ** rng.uniform(-0.1, 0.9)
        if "gravity_load" in wants:
            travel = max(travel, 1.8)
        self.path = draw_trajectory(rng, self.duration_s, travel, 0.04 * self.rate_hz)
        self.inertia = 10.0 ** (rng.uniform(-0.5, 2.0) if self.linear else rng.uniform(-3.0, 0.7))
        _, speed, acceleration = self._motion(self.time_s)
        self.top_speed = float(numpy.max(numpy.abs(speed)))
        inertial = self.inertia * float(numpy.std(acceleration))
        # A delay's whole size must not sit in the few samples of a reversal, which any analyst distrusts.
        self.coulomb = inertial * (rng.uniform(0.02, 0.1) if "time_delay" in wants else rng.uniform(0.15, 0.6))
        self.viscous = inertial * rng.uniform(0.05, 0.5) / float(numpy.std(speed))
        self.offset = inertial * rng.uniform(-0.1, 0.1)
        # The sign of friction changes over a small speed instead of at once.
        self.smoothing_speed = self.top_speed * 10.0 ** (rng.uniform(-3.7, -2.8) + (0.8 if "time_delay" in wants else 0.0))
        self.span = float(numpy.ptp(self._nominal(self.time_s)))
        self.noise_sd = self.span * 10.0 ** rng.uniform(math.log10(0.0025), math.log10(0.015))
        counts_per_turn = 2.0 ** rng.integers(22, 27)
        self.position_step = (2.0 * math.pi if not self.linear else 0.02) / counts_per_turn
        self.stated_inertia = None
        if rng.random() < 0.3 or wrong_number:
            wrong = rng.choice([rng.uniform(0.5, 0.85), rng.uniform(1.15, 1.8)]) if wrong_number else 1.0
            self.stated_inertia = self.inertia * wrong
        bare = "missing_columns" in nuisances
        self.has_speed = not bare and rng.random() < 0.35
        self.has_temperature = not bare and rng.random() < (0.5 if "thermal_friction_drift" in wants else 0.25)
        share = self.time_s / self.duration_s
        self.warming = (rng.uniform(20.0, 30.0), rng.uniform(3.0, 15.0), rng.uniform(0.3, 0.9))
        self.temperature_degC = self._temperature(share)

    def _draw_sampling(self, rng, nuisances):
        self.rate_hz = float(rng.choice([50.0, 100.0, 200.0, 250.0, 500.0, 1000.0, 2000.0],
                                        p=[0.08, 0.17, 0.2, 0.15, 0.2, 0.15, 0.05]))
        self.duration_s = rng.uniform(15.0, 60.0) if self.rate_hz <= 250.0 else rng.uniform(10.0, 20.0)
        if "other_rate" in nuisances:
            self.rate_hz = float(rng.choice([50.0, 125.0, 333.0, 4000.0, 10000.0], p=[0.25, 0.35, 0.25, 0.1, 0.05]))
            self.duration_s = rng.uniform(10.0, 15.0)
        if "short_record" in nuisances:
            self.duration_s = rng.uniform(8.0, 12.0)
        count = int(self.duration_s * self.rate_hz)
        self.time_s = numpy.arange(count) / self.rate_hz
        self.stamp_s = self.time_s
        if "jitter" in nuisances:
            # The logger samples late by a random bit and stamps it, with a small error of the stamp itself.
            late_s = rng.uniform(0.05, 0.35) / self.rate_hz * rng.random(count)
            self.time_s = self.time_s + late_s
            self.stamp_s = self.time_s + 0.002 / self.rate_hz * rng.standard_normal(count)

    def _temperature(self, share):
        start, rise, tau = self.warming
        return start + rise * (1.0 - numpy.exp(-share.clip(0.0) / tau))

    def _motion(self, time_s):
        """The path at the record's own times is asked for again and again."""
        if time_s is not self.time_s:
            return self.path.at(time_s)
        if self._at_samples is None:
            self._at_samples = self.path.at(time_s)
        return self._at_samples

    def direction(self, speed):
        return numpy.tanh(speed / self.smoothing_speed)

    def _nominal(self, time_s):
        _, speed, acceleration = self._motion(time_s)
        return self.inertia * acceleration + self.viscous * speed + self.coulomb * self.direction(speed) + self.offset

    def nominal_parameters(self):
        torque, angle = self.unit, ("m" if self.linear else "rad")
        return {"inertia": (self.inertia, "kg" if self.linear else "kgm2"), "coulomb": (self.coulomb, torque),
                "viscous": (self.viscous, "%s*s/%s" % (torque, angle)), "offset": (self.offset, torque),
                "passage_speed": (self.smoothing_speed, angle + "/s")}

    def sample_count(self):
        return len(self.time_s)

    def regressors(self):
        _, speed, acceleration = self._motion(self.time_s)
        return numpy.stack([acceleration, speed, self.direction(speed), numpy.ones_like(speed)], axis=1)

    def respond(self, effects):
        late_s = sum(scale for effect, scale in effects if effect.name == "time_delay")
        time_s = self.time_s + late_s if late_s else self.time_s
        response = self._nominal(time_s)
        for effect, scale in effects:
            if effect.name != "time_delay":
                response = response + effect.act(scale, time_s)
        return response[numpy.newaxis, :]

    def _term(self, name, function, describe, signature=None):
        """An effect that is `scale` times a function of time in units of the axis' span of torque."""
        return Effect(name, lambda scale, t: scale * self.span * function(t), describe, 0.03, 0.6, signature)

    def _force(self, name, function, parameter, signature=None, more=None):
        def describe(scale):
            return {parameter: (scale * self.span, self.unit), **(more or {})}
        return self._term(name, function, describe, signature)

    def make_effect(self, name, rng):
        motion = self._motion
        sign = float(rng.choice([-1.0, 1.0]))
        if name == "stribeck_friction":
            speed_of_fall, power = self.top_speed * rng.uniform(0.04, 0.15), rng.uniform(1.0, 2.0)
            return self._force(name, lambda t: self.direction(motion(t)[1]) *
                               numpy.exp(-(numpy.abs(motion(t)[1]) / speed_of_fall) ** power), "rise")
        if name == "asymmetric_friction":
            return self._term(name, lambda t: sign * numpy.abs(motion(t)[1]) / self.top_speed, lambda scale: {})
        if name == "position_periodic_torque":
            return self._ripple(rng)
        if name == "gravity_load":
            phase = rng.uniform(-math.pi, math.pi)
            return self._force(name, lambda t: numpy.sin(motion(t)[0] + phase), "amplitude")
        if name == "quadratic_drag":
            return self._term(name, lambda t: motion(t)[1] * numpy.abs(motion(t)[1]) / self.top_speed ** 2,
                              lambda scale: {"drag": (scale * self.span / self.top_speed ** 2,
                                                      self.unit + ("*s^2/m^2" if self.linear else "*s^2/rad^2"))})
        if name == "load_dependent_friction":
            most = self.inertia * float(numpy.max(numpy.abs(motion(self.time_s)[2])))
            return self._term(name, lambda t: numpy.abs(self.inertia * motion(t)[2]) * self.direction(motion(t)[1]) / most,
                              lambda scale: {"coefficient": (scale * self.span / most, "")})
        if name == "thermal_friction_drift":
            course = lambda t: -(self._temperature(t / self.duration_s) - self.temperature_degC[0]) / self.warming[1]
            part = rng.uniform(0.0, 0.8)  # how much of the drift is viscous
            return self._term(name, lambda t: course(t) * ((1.0 - part) * self.direction(motion(t)[1]) +
                                                           part * motion(t)[1] / self.top_speed), lambda scale: {})
        if name == "torsional_resonance":
            highest_hz = min(max(self.path.highest_hz, 0.3) * rng.uniform(1.5, 4.0), 0.12 * self.rate_hz)
            unit_reaction = resonance_reaction(self.path, self.duration_s, highest_hz, rng.uniform(0.01, 0.06))
            return Effect(name, lambda scale, t: scale * self.inertia * unit_reaction(t),
                          lambda scale: {"frequency": (highest_hz, "Hz")}, 0.2, 0.9)
        if name == "backlash":
            return self._backlash(rng)
        if name == "time_delay":
            return Effect(name, None, lambda scale: {"delay": (scale, "s")}, 0.3 / self.rate_hz, 8.0 / self.rate_hz)
        return self._disturbance(rng)

    def _ripple(self, rng):
        reach = float(numpy.ptp(self._motion(self.time_s)[0]))
        orders = [n for n in (2, 3, 4, 6, 8, 10, 12, 16, 24, 36, 48, 60, 80, 100, 160, 200, 320)
                  if n * reach > 4.0 * math.pi and n * self.top_speed < 2.0 * math.pi * 0.2 * self.rate_hz]
        if not orders:
            return None
        order, phase = float(rng.choice(orders)), rng.uniform(-math.pi, math.pi)
        return self._force("position_periodic_torque", lambda t: numpy.sin(order * self._motion(t)[0] + phase), "amplitude",
                           None, {"order": (order, "1/rev")})

    def _backlash(self, rng):
        share = 10.0 ** rng.uniform(-1.8, -0.1)  # of the inertia, behind the gap
        contact_hz = min(max(12.0 * self.path.highest_hz, 8.0), 40.0)
        reach = float(numpy.ptp(self._motion(self.time_s)[0]))
        reaction = backlash_reaction(self.path, self.duration_s, contact_hz, rng.uniform(0.3, 0.7),
                                     self.coulomb / self.inertia * rng.uniform(0.2, 0.6))
        return Effect("backlash", lambda scale, t: share * self.inertia * reaction(scale, t),
                      lambda scale: {"gap": (scale, "m" if self.linear else "rad")}, 0.002 * reach, 0.08 * reach,
                      tolerance=0.015,  # impacts make the size a ragged function of the gap
                      least_scale=0.0005 * reach)

    def _disturbance(self, rng):
        windows = []
        for _ in range(int(rng.integers(1, 4))):
            length_s = rng.uniform(0.3, 2.0)
            start_s = rng.uniform(0.05 * self.duration_s, 0.95 * self.duration_s - length_s)
            windows.append((start_s, start_s + length_s, float(rng.choice([-1.0, 1.0])) * rng.uniform(0.6, 1.0)))
        # Squeezing the edges lets the same formula be a push, an impact or a held force.
        edge = rng.uniform(0.1, 0.5)

        def push(t):
            force = numpy.zeros_like(t)
            for start_s, end_s, height in windows:
                inside = ((t - start_s) / (end_s - start_s)).clip(0.0, 1.0)
                force += height * numpy.sin(0.5 * math.pi * (numpy.minimum(inside, 1.0 - inside) / edge).clip(0.0, 1.0)) ** 2
            return force
        first = min(windows)
        return self._force("external_disturbance", push, "peak", None,
                           {"window_start": (first[0], "s"), "window_end": (first[1], "s")} if len(windows) == 1 else None)

    def make_outside(self, rng):
        which = rng.choice(["force_at_a_place", "wavy_in_speed", "tone_in_time"])
        positions, _, _ = self._motion(self.time_s)
        if which == "force_at_a_place":
            # A cable that drags over one segment of the way, always to the same side, whichever way the axis goes.
            low, high = float(positions.min()), float(positions.max())
            centre, half = low + (high - low) * rng.uniform(0.25, 0.75), (high - low) * rng.uniform(0.04, 0.1)
            hump = lambda t: numpy.cos(0.5 * math.pi * ((self._motion(t)[0] - centre) / half).clip(-1.0, 1.0)) ** 2
            return self._force(which, hump, "peak", {"what": "window", "regressor": "position",
                                                     "window": [centre - half, centre + half], "values": [],
                                                     "tolerance": 0.0, "unit": "m" if self.linear else "rad"})
        if which == "wavy_in_speed":
            waves = rng.uniform(1.6, 2.6)
            wavy = lambda t: numpy.sin(2.0 * math.pi * waves * self._motion(t)[1] / self.top_speed)
            return self._force(which, wavy, "amplitude",
                               {"what": "regressor", "regressor": "velocity", "values": [], "tolerance": 0.0})
        lowest_hz = min(3.0 * self.path.highest_hz, 0.1 * self.rate_hz)
        frequency_hz = 10.0 ** rng.uniform(math.log10(lowest_hz), math.log10(0.25 * self.rate_hz))
        phase = rng.uniform(-math.pi, math.pi)
        return self._force(which, lambda t: numpy.sin(2.0 * math.pi * frequency_hz * t + phase), "amplitude",
                           {"what": "order", "regressor": "time",
                            "values": [frequency_hz, 1.0 / frequency_hz, 2.0 * math.pi * frequency_hz],
                            "tolerance": max(0.02, 0.5 / self.duration_s / frequency_hz), "relative": True})

    def record(self, measured, keep, rng, quantise):
        position, speed, _ = self._motion(self.time_s)
        torque = measured[0]
        if quantise:
            torque = quantise * numpy.round(torque / quantise)
        length, force = ("m", "force_N") if self.linear else ("rad", "torque_Nm")
        columns = {"time_s": (self.stamp_s[keep], "%.7f"),
                   "position_" + length: ((self.position_step * numpy.round(position / self.position_step))[keep], "%.12g"),
                   force: (torque[keep], "%.8g")}
        if self.has_speed:
            noisy = speed + rng.normal(0.0, 0.0005 * self.top_speed, len(speed))
            columns["velocity_%s_per_s" % length] = (noisy[keep], "%.8g")
        if self.has_temperature:
            columns["temperature_degC"] = ((self.temperature_degC + rng.normal(0.0, 0.03, len(speed)))[keep], "%.2f")
        metadata = {"kind": self.kind}
        if self.stated_inertia:
            metadata["mass_kg" if self.linear else "inertia_kgm2"] = "%.5g" % self.stated_inertia
        return metadata, columns
