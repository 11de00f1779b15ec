# SPDX-License-Identifier: Apache-2.0
"""Two lock tests: torque in stairs by the return mapping, and a load servo that drives an inertia against the gear."""
import dataclasses
import math

import numpy

from . import torsion_effects
from .model import Model
from .noise import draw_noise
from .torsion import Balance, Torsion, in_series, twist_under
from .torsion_effects import ARCMIN

CAUSES = ("backlash", "asymmetric_stiffness", "cubic_hardening", "creep", "brake_slip", "thermal_drift", "torque_zero_offset",
          "distributed_friction", "rate_dependence")
NOT_COLOURED = ("creep", "thermal_drift", "brake_slip")


class LoopModel(Model):
    kind, unit, causes, rivals = "hysteresis", "arcmin", CAUSES, CAUSES

    def __init__(self, rng, wants, wrong_number=False):
        self.possible, self.nuisances, self._columns = True, [], None
        gain = float(rng.choice([0.5, 1.5])) if wrong_number else rng.uniform(0.75, 1.3)
        k1, k2, k3 = numpy.sort(numpy.array([1.6e4, 2.5e4, 2.9e4]) * gain * rng.uniform(0.92, 1.08, 3))
        self.limits_Nm = (7.0, 25.0, 34.0) if rng.random() < 0.7 else (round(rng.uniform(4.0, 9.0), 1), round(rng.uniform(16.0, 24.0), 1), 34.0)
        self.torsion = Torsion(k1, k2, k3, self.limits_Nm[0], self.limits_Nm[1], (rng.uniform(0.5, 2.5),), (rng.uniform(0.2, 0.6) / ARCMIN,))
        self.peak_Nm = self.limits_Nm[2]
        self.most_twist = self.peak_Nm / k2
        self.seconds = 10.0 ** rng.uniform(1.3, 2.3)
        self.time_s, self.goal_Nm = self.draw_profile(rng, wants)
        self.typical_rate = float(numpy.mean(numpy.abs(numpy.diff(self.goal_Nm)))) / float(numpy.mean(numpy.diff(self.time_s))) / k2
        coloured = not any(name in NOT_COLOURED for name in wants) and rng.random() < 0.15
        self.nuisances += ["coloured_noise"] * coloured
        self.torque_sd_Nm = rng.uniform(0.002, 0.02) if not coloured and rng.random() < 0.7 else 0.0
        angle_sd_arcmin = 10.0 ** rng.uniform(-2.3, -1.5)
        self.quantum = angle_sd_arcmin * rng.uniform(0.3, 1.5) if rng.random() < 0.4 else 0.0
        self.nuisances += ["quantisation"] * bool(self.quantum)
        self.added = draw_noise(rng, angle_sd_arcmin, coloured)
        sd = math.sqrt(angle_sd_arcmin ** 2 + self.quantum ** 2 / 12.0 + (self.torque_sd_Nm / k2 * ARCMIN) ** 2)
        self.noise = dataclasses.replace(self.added, sd=sd)
        self.warming = (rng.uniform(18.0, 28.0), rng.uniform(0.5, 3.0), rng.uniform(0.2, 0.8), rng.uniform(0.1, 0.4), rng.random())
        self.has_temperature = rng.random() < (0.5 if "thermal_drift" in wants else 0.35)
        self.stated_Nm = list(self.limits_Nm)
        if wrong_number and rng.random() < 0.5:
            self.stated_Nm[:2] = [round(knee * (1.0 + rng.uniform(0.04, 0.12)), 2) for knee in self.limits_Nm[:2]]

    def temperature_degC(self, time_s):
        start, rise, tau, wave, phase = self.warming
        share = time_s / self.time_s[-1]
        return start + rise * (1.0 - numpy.exp(-share / tau)) + wave * numpy.sin(2.0 * math.pi * (0.8 * share + phase))

    def _changed(self, effects):
        torsion = self.torsion
        for effect, scale in effects:
            torsion = effect.act(torsion, scale)
        return torsion

    def residual(self, effects):
        torque, twist = self.measured(self._changed(effects))
        if torque is None:
            return None
        return ((twist - twist_under(self.torsion, self.time_s, torque)) * ARCMIN)[numpy.newaxis, :]

    def regressors(self):
        """By central differences at the clean record's torque, and a constant: the angle's zero is arbitrary."""
        if self._columns is None:
            torque, _ = self.measured(self.torsion)
            columns = [numpy.ones_like(torque)]
            for name in ("k1", "k2", "k3", "levels", "yields"):
                value = getattr(self.torsion, name)
                above, below = (dataclasses.replace(self.torsion, **{name: (value[0] * factor,) if isinstance(value, tuple) else value * factor})
                                for factor in (1.003, 0.997))
                columns.append(twist_under(above, self.time_s, torque) - twist_under(below, self.time_s, torque))
            self._columns = numpy.stack(columns, axis=1)
        return self._columns

    def nominal_parameters(self):
        return {"k1": (self.torsion.k1, "Nm/rad"), "k2": (self.torsion.k2, "Nm/rad"), "k3": (self.torsion.k3, "Nm/rad"),
                "friction_torque": (self.torsion.levels[0], "Nm"), "yield_twist": (self.torsion.yields[0] * ARCMIN, "arcmin")}

    def make_effect(self, name, rng):
        return torsion_effects.make(self, name, rng)

    def make_outside(self, rng):
        return torsion_effects.make_outside(self, rng)

    def record(self, effects, rng):
        torque, twist = self.measured(self._changed(effects))
        angle = twist * ARCMIN + self.added.draw(rng, (1, len(twist)))[0]
        angle = angle - angle[0]
        if self.quantum:
            angle = self.quantum * numpy.round(angle / self.quantum)
        columns = {"time_s": (self.time_s, "%.6f"), "torque_Nm": (torque + self.torque_sd_Nm * rng.standard_normal(len(torque)), "%.5f"),
                   "output_angle_deg": (angle / 60.0, "%.9f")}
        if self.has_temperature:
            columns["temperature_degC"] = (self.temperature_degC(self.time_s) + rng.normal(0.0, 0.02, len(torque)), "%.2f")
        t1, t2, t3 = self.stated_Nm
        return {"kind": self.kind, "t1_Nm": "%g" % t1, "t2_Nm": "%g" % t2, "t3_Nm": "%g" % t3}, columns


class StaircaseLoop(LoopModel):
    """A load motor that goes from step to step and holds (a logarithm needs that), between peaks or with smaller loops inside."""

    def draw_profile(self, rng, wants):
        peaks = [1.0, -1.0] + ([0.6, -1.0] if rng.random() < 0.4 else []) + [1.0, -1.0, 0.0][:int(rng.integers(1, 4))]
        stairs = int(rng.choice([6, 10, 40])) if "rate_dependence" not in wants else 6
        corners = [(0.0, 0.0)]
        paces = rng.permutation(numpy.geomspace(1.0, 8.0, len(peaks))) if "rate_dependence" in wants or rng.random() < 0.3 else numpy.ones(len(peaks))
        hold = rng.uniform(2.0, 6.0) if "creep" in wants or "brake_slip" in wants or rng.random() < 0.3 else 0.4
        for peak, pace in zip(peaks, paces):
            start = corners[-1][1]
            for step in numpy.linspace(start, peak, stairs + 1)[1:]:
                at, level = corners[-1]
                corners += [(at + pace * abs(step - level), float(step)), (at + pace * abs(step - level) + hold * pace / stairs, float(step))]
            corners[-1] = (corners[-1][0] + 0.3 * hold, corners[-1][1])
        times, levels = numpy.array(corners).T
        count = int(10.0 ** rng.uniform(3.0, 3.5))
        time_s = numpy.linspace(0.0, 1.0, count)
        return time_s * self.seconds, self.peak_Nm * numpy.interp(time_s * times[-1], times, levels)

    def measured(self, torsion):
        return self.goal_Nm, twist_under(torsion, self.time_s, self.goal_Nm)


class ServoLoop(LoopModel):
    """A load servo under PI control of the torque that the transducer sees, with an inertia on the gear: the torque follows from
    the twist (leapfrog), overshoots a little and breathes with the current's ripple. Sines and triangles at more than one pace."""
    most_steps = 9000

    def draw_profile(self, rng, wants):
        loops = int(rng.choice([1, 2, 3]))
        paces = numpy.ones(loops)
        if "rate_dependence" in wants or rng.random() < 0.3:
            loops = max(loops, 2)
            paces = rng.permutation(numpy.geomspace(1.0, rng.uniform(4.0, 9.0), loops))
        sine = rng.random() < 0.5 and "creep" not in wants
        hold = rng.uniform(0.1, 0.3) if "creep" in wants else 0.0
        corners = [(0.0, 0.0)]
        for pace in paces:
            for level, part in ((1.0, 0.25), (1.0, hold), (-1.0, 0.5), (-1.0, hold), (0.0, 0.25)):
                corners.append((corners[-1][0] + pace * part, level))
        corners += [(corners[-1][0] + 0.2 * paces[-1], 0.7)] if rng.random() < 0.5 else []
        times, levels = numpy.array(corners).T
        keep = numpy.concatenate([[True], numpy.diff(times) > 0.0])
        count = int(10.0 ** rng.uniform(3.0, 3.4))
        share = numpy.linspace(0.0, 1.0, count)
        triangle = numpy.interp(share * times[-1], times[keep], levels[keep])
        self.ripple_Nm, self.ripple_turns = rng.uniform(0.0, 0.05), rng.uniform(40.0, 90.0)
        return share * self.seconds, self.peak_Nm * (numpy.sin(0.5 * math.pi * triangle) if sine else triangle)

    def measured(self, torsion):
        """Leapfrog in units of the sample's time: the inertia is such that its frequency lies well above the profile's."""
        per_sample = 4
        count = per_sample * (len(self.time_s) - 1) + 1
        grid_s = numpy.linspace(0.0, self.time_s[-1], count)
        step_s = grid_s[1]
        goals = numpy.interp(grid_s, self.time_s, self.goal_Nm) + self.ripple_Nm * numpy.sin(2.0 * math.pi * self.ripple_turns * grid_s / grid_s[-1])
        omega = 0.5 / step_s  # of the inertia on the stiffest piece, with friction's spring beside it
        stiffness = torsion.k3 + self.torsion.levels[0] / self.torsion.yields[0]
        inertia = stiffness / omega ** 2
        damping = 1.2 * inertia * omega
        balance = Balance(torsion, 1.5 * self.peak_Nm + sum(torsion.levels) + 5.0)
        twist = speed = torque = integral = 0.0
        torques, twists = [], []
        goals = goals.tolist()
        for k, goal in enumerate(goals):
            torque = balance.to_twist(twist, step_s)
            if not abs(torque) < 20.0 * self.peak_Nm:
                return None, None
            if k % per_sample == 0:
                torques.append(torque)
                twists.append(twist)
            error = goal - torque
            integral += 0.04 * error
            speed += step_s * (goal + 0.3 * error + integral - torque - damping * speed) / inertia
            twist += step_s * speed
        torque = numpy.array(torques)
        # What lies in series goes with the torque that passes; the transducer shows its zero on top.
        return torque + torsion.torque_zero_Nm, numpy.array(twists) + in_series(torsion, self.time_s, torque)
