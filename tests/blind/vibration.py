# SPDX-License-Identifier: Apache-2.0
"""Vibration records: accelerometers on a reducer at nearly constant or slowly changing input speed."""
import dataclasses
import math

import numpy

from effect import Effect

CAUSES = ("gear_mesh", "bearing_defect", "imbalance", "torsional_resonance", "flexspline_crack")
TEETH = (160.0, 162.0)  # per input turn of the size-20, 1:80 unit: flexspline, circular spline
RATIO = 80.0
MOST_M_PER_S2 = 30.0
NAMES = ("accel_x", "accel_y", "accel_z", "accel_motor_z")


class Vibration:
    kind = "vibration"
    unit = "m/s^2"

    def __init__(self, rng, wants, nuisances, wrong_number=False):
        self.rho = rng.uniform(0.3, 0.8) if "coloured_noise" in nuisances else 0.0
        self.noise_sd = 10.0 ** rng.uniform(-1.3, -0.3)
        self.rate_hz = float(rng.choice([5120.0, 10240.0, 12800.0, 25600.0], p=[0.3, 0.35, 0.2, 0.15]))
        if "other_rate" in nuisances:
            self.rate_hz = float(rng.choice([5000.0, 6667.0, 8192.0, 20000.0]))
        duration_s = rng.uniform(0.8, 3.0) if self.rate_hz < 15000.0 else rng.uniform(0.5, 1.5)
        if "short_record" in nuisances:
            duration_s = 0.5
        speed_rpm = rng.uniform(600.0, 3000.0)
        if "gear_mesh" in wants:  # the mesh must lie inside the band
            speed_rpm = min(speed_rpm, 0.44 * self.rate_hz / TEETH[1] * 60.0 / 1.05)
        if "flexspline_crack" in wants:  # its modulation needs more than one turn of the output
            speed_rpm = max(speed_rpm, 1800.0)
            duration_s = max(duration_s, rng.uniform(90.0, 110.0) * 60.0 / speed_rpm)
        if "imbalance" in wants:
            duration_s = max(duration_s, 1.5)
        self.time_s = numpy.arange(int(duration_s * self.rate_hz)) / self.rate_hz
        self._draw_speed(rng, wants, speed_rpm)
        self.stated_rpm = self.mean_rpm * (1.0 + rng.choice([-1.0, 1.0]) * rng.uniform(0.003, 0.01) if wrong_number else 1.0)
        count = int(rng.choice([1, 2, 3, 4], p=[0.35, 0.25, 0.25, 0.15]))
        picked = sorted(rng.choice(4, count, replace=False).tolist())
        if "imbalance" in wants:
            picked = sorted(set(picked) | {0, 1})
        self.names = [NAMES[index] for index in picked]
        self.gains = rng.uniform(0.4, 1.0, len(self.names))
        self.gains[int(rng.integers(len(self.names)))] = 1.0
        self.harmonics = self.noise_sd * 10.0 ** rng.uniform(-0.5, 0.9, (2, len(self.names)))
        self.phases_rad = rng.uniform(-math.pi, math.pi, (2, len(self.names)))
        self.time_column = "missing_columns" not in nuisances and rng.random() < 0.3

    def _draw_speed(self, rng, wants, speed_rpm):
        share = self.time_s / self.time_s[-1]
        self.varying = "imbalance" in wants or rng.random() < 0.15
        course = numpy.ones_like(share)
        if self.varying:
            swing = rng.uniform(0.2, 0.4) if "imbalance" in wants else rng.uniform(0.03, 0.12)
            if rng.random() < 0.6:
                course += swing * rng.choice([-1.0, 1.0]) * (2.0 * share - 1.0)
            else:
                course += swing * numpy.sin(2.0 * math.pi * (rng.uniform(0.6, 1.5) * share + rng.random()))
            # The fastest part must keep the mesh inside the band as well.
            course /= course.max() if "gear_mesh" in wants else 1.0
        # A servo's speed breathes a little, once a turn and slowly; far too little to smear the mesh lines.
        turn = 2.0 * math.pi * speed_rpm / 60.0 * self.time_s
        course += rng.uniform(0.0, 3e-4) * numpy.sin(turn + rng.random() * 6.28)
        course += rng.uniform(0.0, 2e-5) * numpy.sin(2.0 * math.pi * (rng.uniform(0.5, 2.0) * share + rng.random()))
        self.speed_rpm = speed_rpm * course
        step_s = 1.0 / self.rate_hz
        omega = 2.0 * math.pi * self.speed_rpm / 60.0
        turned = numpy.concatenate([[0.0], numpy.cumsum(0.5 * (omega[1:] + omega[:-1])) * step_s])
        self.angle_rad = rng.uniform(-math.pi, math.pi) + turned
        self.mean_rpm = float(numpy.mean(self.speed_rpm))

    def nominal_parameters(self):
        found = {"input_speed": (self.mean_rpm, "rpm")}
        for order in (1, 2):
            for name, amplitude in zip(self.names, self.harmonics[order - 1]):
                found["harmonic_%d_%s" % (order, name)] = (float(amplitude), self.unit)
        return found

    def sample_count(self):
        return len(self.time_s)

    def regressors(self):
        columns = [numpy.ones_like(self.angle_rad)]
        for order in (1.0, 2.0):
            columns += [numpy.cos(order * self.angle_rad), numpy.sin(order * self.angle_rad)]
        return numpy.stack(columns, axis=1)

    def respond(self, effects):
        response = numpy.zeros((len(self.names), len(self.time_s)))
        for order in (1, 2):
            for channel in range(len(self.names)):
                phase = self.phases_rad[order - 1][channel]
                response[channel] += self.harmonics[order - 1][channel] * numpy.sin(order * self.angle_rad + phase)
        for effect, scale in effects:
            response = response + effect.act(scale)
        return response

    def _shaped(self, name, shape, describe, signature=None):
        """`shape`: channels x samples, at scale 1 of the order of 1 m/s^2 in the strongest channel."""
        return Effect(name, lambda scale: scale * shape, describe, self.noise_sd, MOST_M_PER_S2, signature)

    def _line(self, order, rng, rotate=True):
        """One order in all channels; the way to each sensor turns its phase."""
        phase = rng.uniform(-math.pi, math.pi, len(self.names))
        if not rotate:
            phase[:] = phase[0]
        return self.gains[:, numpy.newaxis] * numpy.sin(order * self.angle_rad + phase[:, numpy.newaxis])

    def _ringing(self, onset_s, heights, natural_hz, damping_ratio):
        """Sum of free responses of a mode, each from its own onset between the samples."""
        out = numpy.zeros(len(self.time_s))
        omega = 2.0 * math.pi * natural_hz
        length = int(min(8.0 / (damping_ratio * omega), 2.0) * self.rate_hz) + 2
        for start_s, height in zip(onset_s, heights):
            first = int(math.ceil(start_s * self.rate_hz))
            if first >= len(out) or first < 0:
                continue
            since_s = self.time_s[first:first + length] - start_s
            out[first:first + length] += height * numpy.exp(-damping_ratio * omega * since_s) * numpy.sin(omega * since_s)
        return out

    def _onsets(self, order, rng, slip):
        """Times at which the input has turned by another 1/order of a turn, the angle there, and the times without slip."""
        first, last = self.angle_rad[0], self.angle_rad[-1]
        count = int((last - first) / (2.0 * math.pi) * order)
        even = numpy.arange(count) + rng.random()
        angles = [first + steps * 2.0 * math.pi / order for steps in (even + slip * rng.standard_normal(count), even)]
        onset_s, even_onset_s = (numpy.interp(angle, self.angle_rad, self.time_s) for angle in angles)
        return onset_s, angles[0], even_onset_s

    def make_effect(self, name, rng):
        level = lambda scale: {}
        if name == "gear_mesh":
            return self._mesh(rng)
        if name == "bearing_defect":
            return self._bearing(rng)
        if name == "imbalance":
            phase, sense = rng.uniform(-math.pi, math.pi), float(rng.choice([-1.0, 1.0]))
            square = (self.speed_rpm / self.mean_rpm) ** 2
            shape = numpy.zeros((len(self.names), len(self.time_s)))
            for channel, channel_name in enumerate(self.names):
                if channel_name in ("accel_x", "accel_y"):
                    turn = 0.0 if channel_name == "accel_x" else -0.5 * math.pi * sense
                    shape[channel] = square * numpy.cos(self.angle_rad + phase + turn)
            return self._shaped(name, shape, level)
        if name == "torsional_resonance":
            return self._resonance(rng)
        order = 2.0 * (1.0 + 1.0 / RATIO)
        # Each pass of the crack by the major axis is a short pulse; the crack's position under load changes once per output turn.
        width, depth = rng.uniform(0.04, 0.09), rng.uniform(0.4, 0.9)
        phase, turn = rng.uniform(-math.pi, math.pi, 2)
        pulses = sum(math.exp(-0.5 * (2.0 * math.pi * width * k) ** 2) * numpy.cos(k * (order * self.angle_rad + phase))
                     for k in range(1, 13))
        pulses *= 1.0 + depth * numpy.cos(self.angle_rad / RATIO + turn)
        return self._shaped(name, self.gains[:, numpy.newaxis] * pulses, lambda scale: {"order": (order, "1/rev")})

    def _mesh(self, rng):
        shape = 0.0
        for order, weight in zip(TEETH, rng.permutation([1.0, rng.uniform(0.4, 1.0)])):
            shape = shape + weight * self._line(order, rng)
            for side in (-2.0, 2.0):
                shape = shape + weight * rng.uniform(0.1, 0.4) * self._line(order + side, rng)
        return self._shaped("gear_mesh", shape, lambda scale: {})

    def _bearing(self, rng):
        balls, ratio = int(rng.integers(19, 26)), rng.uniform(0.07, 0.13)
        race = rng.choice([-1.0, 1.0])  # outer, inner
        order = 0.5 * balls * (1.0 + race * ratio)
        onset_s, angle, even_onset_s = self._onsets(order, rng, 0.003)
        heights = 1.0 + rng.uniform(0.3, 0.8) * numpy.cos(2.0 * angle + rng.uniform(-math.pi, math.pi))
        natural_hz = self.rate_hz * rng.uniform(0.12, 0.32)
        damping_ratio = rng.uniform(0.015, 0.05)
        responses, even = (self._ringing(onsets_s, heights, natural_hz, damping_ratio) for onsets_s in (onset_s, even_onset_s))
        effect = self._shaped("bearing_defect", self.gains[:, numpy.newaxis] * responses, lambda scale: {"order": (order, "1/rev")})
        # Orders as sharp as the ringing harmonics say, resonances a width apart, the phase at which the response begins, and
        # even impulses or a change once or twice a turn with its phase.
        turns = self.mean_rpm / 60.0 * self.time_s[-1]
        harmonic = natural_hz / (self.mean_rpm / 60.0 * order)
        return dataclasses.replace(effect, predicted=lambda scale: scale * self.gains[:, numpy.newaxis] * even,
                                   ln_search_locations=math.log(18.0 * turns * harmonic * 45.0 * 2.0 * 6.0))

    def _resonance(self, rng):
        span_s = self.time_s[-1]
        while True:
            natural_hz = 10.0 ** rng.uniform(1.6, 2.6)
            damping_ratio = max(rng.uniform(0.004, 0.02), 2.0 / (span_s * natural_hz))
            mains = min(abs(natural_hz - multiple * base) for base in (50.0, 60.0) for multiple in (1, 2, 3))
            orders = min(abs(natural_hz - order * self.mean_rpm / 60.0) for order in (1.0, 2.0))
            if min(mains, orders) > 4.0 * damping_ratio * natural_hz / 2.0 and damping_ratio < 0.05:
                break
        impacts = rng.random() < 0.5
        if impacts:  # a few from outside
            onset_s = numpy.sort(rng.uniform(0.02, 0.85, int(rng.integers(1, 5)))) * span_s
            heights = rng.choice([-1.0, 1.0], len(onset_s)) * rng.uniform(0.5, 1.0, len(onset_s))
        else:  # driven by noise of the load
            onset_s = numpy.arange(-int(0.2 * self.rate_hz), len(self.time_s), 16) / self.rate_hz
            onset_s = onset_s[onset_s >= 0.0]
            heights = rng.standard_normal(len(onset_s)) * math.sqrt(damping_ratio * natural_hz * 32.0 / self.rate_hz)
        response = self._ringing(onset_s, heights, natural_hz, damping_ratio)
        effect = self._shaped("torsional_resonance", self.gains[:, numpy.newaxis] * response,
                              lambda scale: {"frequency": (natural_hz, "Hz"), "damping": (damping_ratio, "")})
        # Resonances a width apart with three dampings; each impact in any half period.
        ln_search_locations = math.log(650.0)
        if impacts:
            ln_search_locations += len(onset_s) * math.log(2.0 * natural_hz * span_s) - math.lgamma(len(onset_s) + 1.0)
        return dataclasses.replace(effect, ln_search_locations=ln_search_locations,
                                   driven_mode=None if impacts else (natural_hz, damping_ratio))

    def make_outside(self, rng):
        turn_hz = self.mean_rpm / 60.0
        amplitude = lambda scale: {"amplitude": (scale, self.unit)}
        if self.varying or rng.random() < 0.6:
            order = float(rng.choice([3.7, 5.4, 7.3, 8.6, 14.55]))
            return self._shaped("strange_order", self._line(order, rng), amplitude,
                                {"what": "order", "regressor": "input_angle",
                                 "values": [order, order * turn_hz, order * RATIO], "tolerance": 0.02, "relative": True})
        hum_hz = float(rng.choice([50.0, 60.0, 100.0, 150.0]))
        if abs(hum_hz / turn_hz - round(hum_hz / turn_hz)) * turn_hz < 4.0 / self.time_s[-1]:
            return None
        phase = rng.uniform(-math.pi, math.pi)
        shape = self.gains[:, numpy.newaxis] * numpy.sin(2.0 * math.pi * hum_hz * self.time_s + phase)
        return self._shaped("mains_hum", shape, amplitude, {"what": "order", "regressor": "time",
                                                            "values": [hum_hz, hum_hz / turn_hz], "tolerance": 0.02,
                                                            "relative": True})

    def record(self, measured, keep, rng, quantise):
        columns = {}
        if self.time_column:
            columns["time_s"] = (self.time_s[keep], "%.9f")
        for channel, name in enumerate(self.names):
            values = measured[channel]
            if quantise:
                values = quantise * numpy.round(values / quantise)
            columns[name + "_m_per_s2"] = (values[keep], "%.6g")
        metadata = {"kind": self.kind, "input_speed_rpm": "%.2f" % self.stated_rpm}
        if not self.time_column:
            metadata["sample_rate_hz"] = "%g" % self.rate_hz
        if self.varying:
            noisy = self.speed_rpm * self.stated_rpm / self.mean_rpm * (1.0 + 1e-4 * rng.standard_normal(len(self.time_s)))
            columns["input_speed_rpm"] = (noisy[keep], "%.4f")
        return metadata, columns
