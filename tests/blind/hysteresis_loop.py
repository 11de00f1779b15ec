# SPDX-License-Identifier: Apache-2.0
"""The lock test's physics: twist of a locked reducer under a torque that goes to and fro.

Between two reversals twist is a monotone function of torque, so each branch is one inverted curve on a fine grid; where the
rate matters the same balance is stepped implicitly in time.
"""
import dataclasses
import math

import numpy

from effect import recursion

GRID_POINTS = 6000


@dataclasses.dataclass
class Loop:
    """Everything that shapes twist, SI. Effects change a copy of it."""
    k1_Nm_per_rad: float
    k2_Nm_per_rad: float
    k3_Nm_per_rad: float
    t1_Nm: float
    t2_Nm: float
    friction_Nm: float
    yield_rad: float
    rounding: float  # of a knee, as a share of its torque
    positive_gain: float = 1.0
    negative_gain: float = 1.0
    cubic_Nm_per_rad3: float = 0.0
    viscous_Nm_s_per_rad: float = 0.0
    spread_share: float = 0.0
    spread_yields: tuple = ()  # relative to yield_rad
    torque_zero_Nm: float = 0.0
    ripple_Nm: float = 0.0
    ripple_period_rad: float = 1.0
    ripple_phase_rad: float = 0.0
    after: tuple = ()  # functions of (time_s, true torque) -> twist in series with the loop

    def spring_Nm(self, twist_rad):
        # A side that is stiffer by a gain reaches each torque, its knees included, at a twist smaller by that gain.
        size = numpy.abs(twist_rad) * numpy.where(twist_rad >= 0.0, self.positive_gain, self.negative_gain)
        knee1_rad = self.t1_Nm / self.k1_Nm_per_rad
        knee2_rad = knee1_rad + (self.t2_Nm - self.t1_Nm) / self.k2_Nm_per_rad
        torque = self.k1_Nm_per_rad * size
        for knee_rad, change in ((knee1_rad, self.k2_Nm_per_rad - self.k1_Nm_per_rad),
                                 (knee2_rad, self.k3_Nm_per_rad - self.k2_Nm_per_rad)):
            width_rad = self.rounding * knee_rad
            at_zero = 0.5 * (math.hypot(knee_rad, width_rad) - knee_rad)
            torque = torque + change * (0.5 * (size - knee_rad + numpy.hypot(size - knee_rad, width_rad)) - at_zero)
        torque = torque + self.cubic_Nm_per_rad3 * size ** 3
        ripple = 0.0
        if self.ripple_Nm:
            angle = 2.0 * math.pi * twist_rad / self.ripple_period_rad
            ripple = self.ripple_Nm * numpy.sin(angle + self.ripple_phase_rad)
        return numpy.sign(twist_rad) * torque + ripple

    def elements(self):
        """Friction torques and stiffnesses of the elasto-plastic elements in parallel."""
        levels = [self.friction_Nm * (1.0 - self.spread_share)]
        yields = [self.yield_rad]
        for relative in self.spread_yields:
            levels.append(self.friction_Nm * self.spread_share / len(self.spread_yields))
            yields.append(self.yield_rad * relative)
        return numpy.array(levels), numpy.array(levels) / numpy.array(yields)

    def _reach_rad(self, most_Nm):
        softest = min(self.k1_Nm_per_rad, self.k2_Nm_per_rad, self.k3_Nm_per_rad)
        softest *= min(self.positive_gain, self.negative_gain)
        return 1.2 * (most_Nm + self.friction_Nm + abs(self.ripple_Nm)) / softest

    def twist_rad(self, time_s, torque_Nm, reversals):
        """`torque_Nm` on a fine time grid; `reversals` are the indices where its direction may change, ends included."""
        true_Nm = torque_Nm - self.torque_zero_Nm
        if self.viscous_Nm_s_per_rad > 0.0:
            twist = self._step_in_time(time_s, true_Nm)
        else:
            twist = self._branch_by_branch(true_Nm, reversals)
        for function in self.after:
            twist = twist + function(time_s, true_Nm)
        return twist

    def _branch_by_branch(self, torque_Nm, reversals):
        levels, stiffness = self.elements()
        reach_rad = self._reach_rad(float(numpy.max(numpy.abs(torque_Nm))))
        grid = numpy.linspace(-reach_rad, reach_rad, 2 * GRID_POINTS + 1)
        spring = self.spring_Nm(grid)
        state = [0.0, numpy.zeros_like(levels)]

        def go(torques):
            here_rad, held = state
            up = torques[-1] >= torques[0]
            # Exact knots at the reversal and where an element yields keep interpolation from blurring the corners.
            knots = here_rad + (numpy.where(up, levels, -levels) - held) / stiffness.clip(1e-9)
            line = numpy.unique(numpy.concatenate([grid, [here_rad], knots]))
            line = line[line >= here_rad] if up else line[line <= here_rad][::-1]
            line = line[numpy.abs(line) <= reach_rad]
            friction = numpy.zeros_like(line)
            for level, slope, start in zip(levels, stiffness, held):
                friction += numpy.clip(start + slope * (line - here_rad), -level, level)
            total = numpy.interp(line, grid, spring) + friction
            sign = 1.0 if up else -1.0
            total = numpy.maximum.accumulate(sign * total)
            total = total + 1e-12 * numpy.arange(len(total))
            twist = numpy.interp(sign * torques, total, line)
            state[:] = [float(twist[-1]), numpy.clip(held + stiffness * (twist[-1] - here_rad), -levels, levels)]
            return twist

        # The record begins at rest under its first torque, which came up before.
        go(numpy.array([0.0, torque_Nm[0]]))
        twist = numpy.zeros_like(torque_Nm)
        for first, last in zip(reversals[:-1], reversals[1:]):
            twist[first:last + 1] = go(torque_Nm[first:last + 1])
        return twist

    def _step_in_time(self, time_s, torque_Nm):
        """T = spring + friction + c dphi/dt, implicit in twist: Newton steps on scalars, one table for the spring."""
        levels, stiffness = (values.tolist() for values in self.elements())
        reach_rad = self._reach_rad(float(numpy.max(numpy.abs(torque_Nm))))
        cells = 4000
        table = self.spring_Nm(numpy.linspace(-reach_rad, reach_rad, cells + 1)).tolist()
        cell_rad = 2.0 * reach_rad / cells
        held = [0.0] * len(levels)
        twist = []
        here = 0.0
        times, torques = time_s.tolist(), torque_Nm.tolist()
        for k in range(len(times)):
            # Before its first sample the record was at rest.
            damping = self.viscous_Nm_s_per_rad / (times[k] - times[k - 1]) if k > 0 else 0.0
            guess = here
            for _ in range(12):
                at = min(max((guess + reach_rad) / cell_rad, 0.0), cells - 1e-6)
                cell = int(at)
                slope = (table[cell + 1] - table[cell]) / cell_rad
                balance = table[cell] + slope * (at - cell) * cell_rad + damping * (guess - here) - torques[k]
                slope += damping
                for level, spring, start in zip(levels, stiffness, held):
                    friction = start + spring * (guess - here)
                    if friction > level:
                        balance += level
                    elif friction < -level:
                        balance -= level
                    else:
                        balance += friction
                        slope += spring
                move = balance / slope
                guess -= move
                if abs(move) < 1e-11:
                    break
            held = [min(max(start + spring * (guess - here), -level), level)
                    for level, spring, start in zip(levels, stiffness, held)]
            here = guess
            twist.append(here)
        return numpy.array(twist)


def lag(time_s, values, tau_s):
    """First-order lag, exact for an input that is straight between the samples; the time grid is even."""
    step = (time_s[1] - time_s[0]) / tau_s
    keep = math.exp(-step)
    ahead = 1.0 - (1.0 - keep) / step
    behind = (1.0 - keep) / step - keep
    push = numpy.empty_like(values)
    push[0] = values[0]
    push[1:] = ahead * values[1:] + behind * values[:-1]
    return recursion(push, keep)
