# SPDX-License-Identifier: Apache-2.0
"""Accelerometers on a reducer: forces that reach them through a structure. Two machines: modes at steady speed, paths in a run-up."""
import math

import numpy

from . import vibration_effects
from .model import Model
from .noise import draw_noise, shared_mixing
from .vibration_effects import MESH_ORDER

CAUSES = ("gear_mesh", "bearing_defect", "imbalance", "torsional_resonance", "flexspline_crack")
NAMES = ("accel_x", "accel_y", "accel_z", "accel_motor_z")


class VibrationModel(Model):
    """A concrete machine gives `draw_course(rng, share, wants)` (speed over its mean) and `draw_paths(rng)`."""
    kind, unit, causes = "vibration", "m/s^2", CAUSES
    rates_hz = (5120.0, 8192.0, 10240.0)

    def __init__(self, rng, wants, wrong_number=False):
        self.possible, self.nuisances = True, []
        self.rate_hz = float(rng.choice(self.rates_hz))
        duration_s = rng.uniform(1.0, 2.5)
        speed_rpm = rng.uniform(600.0, 2800.0)
        if "flexspline_crack" in wants:  # more than one turn of the output
            speed_rpm = rng.uniform(1800.0, 2800.0)
            duration_s = max(duration_s, rng.uniform(92.0, 120.0) * 60.0 / speed_rpm)
        if "imbalance" in wants:
            duration_s = max(duration_s, 1.8)
        if "gear_mesh" in wants:
            speed_rpm = min(speed_rpm, 0.4 * self.rate_hz / MESH_ORDER * 60.0 / 1.4)
        count = int(duration_s * self.rate_hz)
        self.time_s = numpy.arange(count) / self.rate_hz
        share = self.time_s / self.time_s[-1]
        course = self.draw_course(rng, share, wants)
        self.speed_rpm = speed_rpm * course
        omega = 2.0 * math.pi * self.speed_rpm / 60.0
        self.angle_rad = rng.uniform(-3.0, 3.0) + numpy.concatenate([[0.0], numpy.cumsum(0.5 * (omega[1:] + omega[:-1]))]) / self.rate_hz
        self.mean_rpm = float(self.speed_rpm.mean())
        self.varying = bool(numpy.ptp(course) > 0.02)
        self.stated_rpm = self.mean_rpm * (1.0 + (float(rng.choice([-1.0, 1.0])) * rng.uniform(0.003, 0.01) if wrong_number else 0.0))
        picked = sorted(rng.choice(4, int(rng.integers(1, 5)), replace=False).tolist())
        if "imbalance" in wants:
            picked = sorted(set(picked) | {0, 1})
        self.names = [NAMES[index] for index in picked]
        channels = len(self.names)
        coloured = "torsional_resonance" not in wants and rng.random() < 0.2
        self.nuisances += ["coloured_noise"] * coloured
        self.noise = draw_noise(rng, 10.0 ** rng.uniform(-1.3, -0.3), coloured)
        if channels > 1 and rng.random() < 0.4:
            self.noise.mixing = shared_mixing(rng, channels)
            self.nuisances.append("shared_noise")
        self.quantum = self.noise.sd * rng.uniform(0.1, 0.5) if rng.random() < 0.4 else 0.0
        self.nuisances += ["quantisation"] * bool(self.quantum)
        self.harmonics = self.noise.sd * 10.0 ** rng.uniform(-0.5, 0.9, (2, channels))
        self.phases_rad = rng.uniform(-math.pi, math.pi, (2, channels))
        self.hertz = numpy.fft.rfftfreq(2 * count, 1.0 / self.rate_hz)
        self.paths = self.draw_paths(rng)  # channels x frequencies
        self.time_column = rng.random() < 0.3

    def through(self, force):
        """A force at every channel. Twice the length, so that its end does not come round to its beginning."""
        count = len(self.time_s)
        spectrum = numpy.fft.rfft(force, 2 * count)
        return numpy.stack([numpy.fft.irfft(path * spectrum, 2 * count)[:count] for path in self.paths])

    def mode(self, natural_hz, damping):
        """Acceleration by force of one mode, 1 far above it."""
        ratio = self.hertz / natural_hz
        return -ratio ** 2 / (1.0 - ratio ** 2 + 2j * damping * ratio)

    def residual(self, effects):
        return sum((effect.act(scale) for effect, scale in effects), numpy.zeros((len(self.names), len(self.time_s))))

    def regressors(self):
        columns = [numpy.ones_like(self.angle_rad)]
        for order in (1.0, 2.0):
            columns += [numpy.cos(order * self.angle_rad), numpy.sin(order * self.angle_rad)]
        return numpy.stack(columns, axis=1)

    def nominal_parameters(self):
        return {"input_speed": (self.mean_rpm, "rpm")}

    def make_effect(self, name, rng):
        return vibration_effects.make(self, name, rng)

    def make_outside(self, rng):
        return vibration_effects.make_outside(self, rng)

    def record(self, effects, rng):
        values = self.residual(effects) + self.noise.draw(rng, (len(self.names), len(self.time_s)))
        for order in (1, 2):
            values += self.harmonics[order - 1][:, numpy.newaxis] * numpy.sin(order * self.angle_rad + self.phases_rad[order - 1][:, numpy.newaxis])
        if self.quantum:
            values = self.quantum * numpy.round(values / self.quantum)
        columns = {"time_s": (self.time_s, "%.9f")} if self.time_column else {}
        for name, row in zip(self.names, values):
            columns[name + "_m_per_s2"] = (row, "%.6g")
        metadata = {"kind": self.kind, "input_speed_rpm": "%.3f" % self.stated_rpm}
        if not self.time_column:
            metadata["sample_rate_hz"] = "%g" % self.rate_hz
        if self.varying:
            noisy = self.speed_rpm * self.stated_rpm / self.mean_rpm * (1.0 + 1e-4 * rng.standard_normal(len(self.time_s)))
            columns["input_speed_rpm"] = (noisy, "%.4f")
        return metadata, columns


class ModalVibration(VibrationModel):
    """Modes of the housing, which every channel has with a gain of its own. Steady speed, or two levels with a ramp between them."""

    def draw_course(self, rng, share, wants):
        course = 1.0 + rng.uniform(0.0, 1e-4) * numpy.sin(2.0 * math.pi * (2.0 * share + rng.random()))
        self.steady = "imbalance" not in wants and rng.random() < 0.7
        if not self.steady:
            at, width = rng.uniform(0.35, 0.65), rng.uniform(0.1, 0.25)
            x = ((share - at) / width + 0.5).clip(0.0, 1.0)
            course += float(rng.choice([-1.0, 1.0])) * rng.uniform(0.2, 0.35) * (x * x * (3.0 - 2.0 * x) - 0.5)
        return course

    def draw_paths(self, rng):
        modes = [self.mode(self.rate_hz * share, rng.uniform(0.02, 0.06)) for share in numpy.sort(rng.uniform(0.1, 0.4, 3))]
        paths = numpy.stack([sum(rng.uniform(-1.0, 1.0) * mode for mode in modes) + 0.2 for _ in self.names])
        return paths / numpy.sqrt(numpy.mean(numpy.abs(paths) ** 2))


class RunUpVibration(VibrationModel):
    """Each channel hears the force late, with a low-pass and an echo. A run-up or a coast-down, straight or exponential."""
    rates_hz = (6000.0, 7500.0, 10000.0)

    def draw_course(self, rng, share, wants):
        swing = rng.uniform(0.25, 0.4) if "imbalance" in wants else rng.choice([0.0, rng.uniform(0.05, 0.3)])
        rise = share if rng.random() < 0.5 else (1.0 - numpy.exp(-2.0 * share)) / (1.0 - math.exp(-2.0))
        course = 1.0 + float(rng.choice([-1.0, 1.0])) * swing * (rise - 0.5)
        return course + rng.uniform(0.0, 5e-5) * numpy.sin(2.0 * math.pi * (3.0 * share + rng.random()))

    def draw_paths(self, rng):
        paths = []
        for _ in self.names:
            late_s, corner_hz = rng.uniform(0.0, 1e-3), self.rate_hz * rng.uniform(0.15, 0.45)
            echo, echo_s = rng.uniform(-0.4, 0.4), rng.uniform(0.5e-3, 3e-3)
            path = numpy.exp(-2j * math.pi * self.hertz * late_s) / (1.0 + 1j * self.hertz / corner_hz)
            paths.append(rng.uniform(0.4, 1.0) * path * (1.0 + echo * numpy.exp(-2j * math.pi * self.hertz * echo_s)))
        ringing = self.mode(self.rate_hz * rng.uniform(0.15, 0.35), rng.uniform(0.03, 0.08))
        return numpy.stack(paths) * (1.0 + 0.5 * ringing)
