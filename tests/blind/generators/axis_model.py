# SPDX-License-Identifier: Apache-2.0
"""Records of motion from an axis simulated in closed loop: its draw, its drive's trace, its nominal inverse dynamics."""
import dataclasses
import math

import numpy

from . import axis_effects
from .axis import Axis, Encoder, Hidden, nominal_columns, simulate
from .model import Model
from .noise import draw_noise

CAUSES = ("stribeck_friction", "asymmetric_friction", "position_periodic_torque", "gravity_load", "quadratic_drag",
          "load_dependent_friction", "thermal_friction_drift", "torsional_resonance", "backlash", "time_delay",
          "external_disturbance")
# Slow noise looks like these.
NOT_COLOURED = ("thermal_friction_drift", "torsional_resonance", "external_disturbance")


class AxisModel(Model):
    """A concrete axis gives `integrator`, `path(rng, ...)`, `draw_friction(rng)`, `draw_controller(rng)` and `draw_trace(rng)`."""
    kind, unit, causes = "motion", "Nm", CAUSES
    rivals = ("stribeck_friction", "asymmetric_friction", "gravity_load", "quadratic_drag", "load_dependent_friction",
              "thermal_friction_drift")
    integrator, substeps = None, 2
    seconds = (7.0, 11.0)

    def __init__(self, rng, wants, wrong_number=False):
        self.cycle_s = 0.001
        self.rate_hz = float(rng.choice([200.0, 250.0, 500.0]))
        self.duration_s = rng.uniform(*self.seconds)
        count = int(self.duration_s / self.cycle_s)
        travel = 10.0 ** rng.uniform(0.0, 0.7)
        if "gravity_load" in wants:
            travel = max(travel, 1.8)
        self.reference = self.path(rng, count, self.cycle_s, travel)
        speed = numpy.diff(self.reference) / self.cycle_s
        acceleration = numpy.diff(speed) / self.cycle_s
        self.top_speed = float(numpy.max(numpy.abs(speed)))
        self.top_acceleration = float(numpy.quantile(numpy.abs(acceleration), 0.995))
        self.lowest, self.highest = float(self.reference.min()), float(self.reference.max())
        self.reach = self.highest - self.lowest
        # Below it lies nearly all of the motion.
        power = numpy.abs(numpy.fft.rfft(acceleration * numpy.hanning(len(acceleration)))) ** 2
        self.highest_hz = max(0.5, float(numpy.searchsorted(numpy.cumsum(power), 0.9 * power.sum())) / (len(acceleration) * self.cycle_s))
        inertia = 10.0 ** rng.uniform(-2.5, 0.3)
        inertial = inertia * float(numpy.std(acceleration))
        few = "time_delay" in wants
        coulomb = inertial * (rng.uniform(0.04, 0.12) if few else rng.uniform(0.15, 0.5))
        viscous = inertial * rng.uniform(0.05, 0.4) / float(numpy.std(speed))
        self.axis = Axis(inertia, viscous, coulomb, inertial * rng.uniform(-0.1, 0.1), self.draw_friction(rng), self.integrator,
                         self.cycle_s, self.substeps)
        self.span = float(numpy.ptp(inertia * acceleration + viscous * speed[1:] + coulomb * numpy.sign(speed[1:])))
        lines = 2.0 ** rng.integers(10, 13)
        period = 2.0 * math.pi / lines
        self.encoder = Encoder(period / 2.0 ** rng.integers(12, 15), period * 10.0 ** rng.uniform(-5.0, -4.2), period, rng.uniform(0.0, 6.28))
        self.controller = self.draw_controller(rng)
        self.coloured = not any(name in NOT_COLOURED for name in wants) and rng.random() < 0.2
        self.noise = draw_noise(rng, self.span * 10.0 ** rng.uniform(-2.4, -1.8), self.coloured)
        self.filter_s, self.mean_over_sample = self.draw_trace(rng)
        self._draw_logger(rng, wants, wrong_number)
        self.clean = self._run(())
        self.possible = self.clean is not None
        if self.possible:
            self._columns = nominal_columns(self.axis, self.clean)
            self._clean_residual = self._cycle_residual(self.clean)

    def _draw_logger(self, rng, wants, wrong_number):
        count = int((self.duration_s - 0.1) * self.rate_hz)
        self.time_s = 0.05 + numpy.arange(count) / self.rate_hz
        self.nuisances = ["coloured_noise"] * self.coloured
        self.stamp_s = self.time_s
        if not self.mean_over_sample and rng.random() < 0.3:
            self.nuisances.append("jitter")
            self.time_s = self.time_s + rng.uniform(-0.2, 0.2, count) / self.rate_hz
            self.stamp_s = self.time_s + 0.002 / self.rate_hz * rng.standard_normal(count)
        self.held_share = rng.uniform(0.001, 0.004) if rng.random() < 0.3 else 0.0
        self.nuisances += ["held_samples"] * bool(self.held_share)
        self.quantum = self.noise.sd * rng.uniform(0.3, 1.2) if rng.random() < 0.4 else 0.0
        self.nuisances += ["quantisation"] * bool(self.quantum)
        if self.quantum:
            self.noise = dataclasses.replace(self.noise, sd=math.hypot(self.noise.sd, self.quantum / math.sqrt(12.0)))
        self.has_speed = rng.random() < 0.35
        self.has_temperature = rng.random() < (0.5 if "thermal_friction_drift" in wants else 0.25)
        self.warming = (rng.uniform(18.0, 30.0), rng.uniform(3.0, 15.0), self.duration_s * rng.uniform(0.3, 0.8))
        self.stated_inertia = None
        if wrong_number or rng.random() < 0.3:
            self.stated_inertia = self.axis.inertia * (float(rng.choice([rng.uniform(0.5, 0.85), rng.uniform(1.15, 1.8)])) if wrong_number else 1.0)

    def temperature_degC(self, time_s):
        start, rise, tau_s = self.warming
        return start + rise * (1.0 - numpy.exp(-numpy.maximum(time_s, 0.0) / tau_s))

    def thermal_course(self, law, rng):
        """Share of the change by time: of the measured temperature, where there is one."""
        tau_s, lag_s = self.warming[2], self.duration_s * rng.uniform(0.05, 0.15)
        if law == "exponential_in_temperature":
            bend = rng.uniform(0.4, 1.5)
            return lambda t: (1.0 - math.exp(-bend * (1.0 - math.exp(-t / tau_s)))) / (1.0 - math.exp(-bend))
        if law == "bearing_and_grease":  # what rubs is warm before the sensor is
            return lambda t: 1.0 - 0.85 * math.exp(-t / tau_s) - 0.15 * math.exp(-t / lag_s)
        return lambda t: 0.8 * (1.0 - math.exp(-t / tau_s)) + 0.2 * t / self.duration_s

    def _run(self, effects):
        hidden = Hidden()
        for effect, scale in effects:
            more = effect.act(scale)
            hidden = Hidden(hidden.terms + more.terms, hidden.late_s + more.late_s, hidden.lags_s + more.lags_s,
                            more.coupling or hidden.coupling)
        return simulate(self.axis, self.reference, self.encoder, self.controller(self.axis, self.reference.tolist(), self.cycle_s), hidden)

    def _cycle_residual(self, run):
        axis = self.axis
        return run.torque - nominal_columns(axis, run) @ numpy.array([axis.inertia, axis.viscous, axis.coulomb, axis.offset])

    def _smoothed(self, values):
        """The trace's low-pass, alike in all channels."""
        if not self.filter_s:
            return values
        keep, out, last = math.exp(-self.cycle_s / self.filter_s), [], values[0]
        for value in values.tolist():
            last = keep * last + (1.0 - keep) * value
            out.append(last)
        return numpy.array(out)

    def _sampled(self, cycles):
        """Means over control cycles, at the record's own times (or as means over its samples)."""
        values = self._smoothed(cycles)
        if self.mean_over_sample:
            sums = numpy.concatenate([[0.0], numpy.cumsum(values)])
            grid_s, half_s = self.cycle_s * numpy.arange(len(sums)), 0.5 / self.rate_hz
            upper, lower = (numpy.interp(self.time_s + side, grid_s, sums) for side in (half_s, -half_s))
            return (upper - lower) * self.cycle_s * self.rate_hz
        return numpy.interp(self.time_s, self.cycle_s * (numpy.arange(len(values)) + 0.5), values)

    def _sampled_position(self, run):
        """Between two cycles as Hermite's cubic: the speed is known there."""
        position, speed = self._smoothed(run.position), self._smoothed(run.speed)
        if self.mean_over_sample:
            middles = 0.5 * (position[1:] + position[:-1]) - self.cycle_s / 12.0 * numpy.diff(speed)
            filter_s, self.filter_s = self.filter_s, 0.0
            sampled = self._sampled(middles)
            self.filter_s = filter_s
            return sampled
        at = numpy.minimum((self.time_s / self.cycle_s).astype(int), len(run.torque) - 1)
        x = self.time_s / self.cycle_s - at
        first, second = position[at], position[at + 1]
        return ((1.0 + 2.0 * x) * (1.0 - x) ** 2 * first + x * (1.0 - x) ** 2 * self.cycle_s * speed[at] +
                x * x * (3.0 - 2.0 * x) * second + x * x * (x - 1.0) * self.cycle_s * speed[at + 1])

    def residual(self, effects):
        run = self._run(effects)
        if run is None:
            return None
        return self._sampled(self._cycle_residual(run) - self._clean_residual)[numpy.newaxis, :]

    def rival_residual(self, effect):
        """On the clean path: rivals are many, and all are terms of a sum."""
        (term,) = effect.act(effect.first_scale).terms
        acceleration, speed, share, _ = self._columns.T
        time_s = self.cycle_s * numpy.arange(len(speed))
        rows = zip(time_s.tolist(), self.clean.position.tolist(), speed.tolist(), acceleration.tolist(), share.tolist())
        return self._sampled(numpy.array([term(*row) for row in rows]))[numpy.newaxis, :]

    def regressors(self):
        """The nominal parameters' directions; the friction's deflection is one of them."""
        other = nominal_columns(self.axis, self.clean, 1.02)[:, 2] - self._columns[:, 2]
        return numpy.stack([self._sampled(column) for column in self._columns.T] + [self._sampled(other)], axis=1)

    def departure(self):
        """What the contract's friction, a sign of the speed, leaves of the clean torque: presliding."""
        acceleration, speed, _, ones = (self._sampled(column) for column in self._columns.T)
        columns = numpy.stack([acceleration, speed, numpy.tanh(speed / (0.002 * self.top_speed)), ones], axis=1)
        torque = self._sampled(self.clean.torque)
        return (torque - columns @ numpy.linalg.lstsq(columns, torque, rcond=None)[0])[numpy.newaxis, :]

    def nominal_parameters(self):
        return {"inertia": (self.axis.inertia, "kgm2"), "coulomb": (self.axis.coulomb, "Nm"),
                "viscous": (self.axis.viscous, "Nm*s/rad"), "offset": (self.axis.offset, "Nm")}

    def make_effect(self, name, rng):
        return axis_effects.make(self, name, rng)

    def make_outside(self, rng):
        return axis_effects.make_outside(self, rng)

    def record(self, effects, rng):
        run = self._run(effects)
        torque = self._sampled(run.torque)
        noise = dataclasses.replace(self.noise, sd=math.sqrt(self.noise.sd ** 2 - self.quantum ** 2 / 12.0))
        torque = torque + noise.draw(rng, (1, len(torque)))[0]
        if self.quantum:
            torque = self.quantum * numpy.round(torque / self.quantum)
        if self.held_share:  # the bus brought nothing new
            for at in 1 + rng.choice(len(torque) - 1, max(int(self.held_share * len(torque)), 1), replace=False):
                torque[at] = torque[at - 1]
        position = self._sampled_position(run)
        position = position + self.encoder.wave * numpy.sin(2.0 * math.pi * position / self.encoder.period + self.encoder.phase)
        step = self.encoder.step if not (self.filter_s or self.mean_over_sample) else self.encoder.step / 64.0
        columns = {"time_s": (self.stamp_s, "%.7f"), "position_rad": (step * numpy.round(position / step), "%.12g"),
                   "torque_Nm": (torque, "%.8g")}
        if self.has_speed:
            speed = self._sampled(numpy.diff(run.position) / self.cycle_s)
            columns["velocity_rad_per_s"] = (speed + rng.normal(0.0, 0.0005 * self.top_speed, len(speed)), "%.8g")
        if self.has_temperature:
            columns["temperature_degC"] = (self.temperature_degC(self.time_s) + rng.normal(0.0, 0.03, len(torque)), "%.2f")
        metadata = {"kind": self.kind}
        if self.stated_inertia:
            metadata["inertia_kgm2"] = "%.5g" % self.stated_inertia
        return metadata, columns
