# SPDX-License-Identifier: Apache-2.0
"""A locked gear: spring, friction elements in parallel, a branch that depends on the rate. Torque from twist and twist from torque.

The friction elements are elasto-plastic; twist is found by the return mapping of computational plasticity (Simo 1998):
an elastic trial, each element cut back to its level, Newton's steps on the balance with the tangent that belongs to it.
"""
import bisect
import dataclasses
import typing

import numpy


@dataclasses.dataclass
class Torsion:
    """SI. `levels` and `yields` of the friction elements; effects change a copy."""
    k1: float
    k2: float
    k3: float
    t1_Nm: float
    t2_Nm: float
    levels: tuple
    yields: tuple
    shape: typing.Optional[typing.Callable] = None  # (twist array, spring torque array) -> spring torque array
    rate: typing.Optional[typing.Callable] = None  # () -> object with step(twist change, seconds) -> (torque, tangent, commit)
    after: tuple = ()  # (time_s, torque) -> twist in series with all this
    torque_zero_Nm: float = 0.0

    def spring(self, twist):
        size = numpy.abs(twist)
        knee1 = self.t1_Nm / self.k1
        knee2 = knee1 + (self.t2_Nm - self.t1_Nm) / self.k2
        torque = numpy.sign(twist) * (self.k1 * numpy.minimum(size, knee1) + self.k2 * (numpy.minimum(size, knee2) - knee1).clip(0.0) +
                                      self.k3 * (size - knee2).clip(0.0))
        return self.shape(twist, torque) if self.shape else torque


class Balance:
    """The state of a torsion that is stepped; its spring as a table, refined about zero and at the knees."""

    def __init__(self, torsion, most_Nm):
        self.torsion = torsion
        reach = 1.6 * most_Nm / min(torsion.k1, torsion.k2, torsion.k3) + 2e-4
        knee1 = torsion.t1_Nm / torsion.k1
        knee2 = knee1 + (torsion.t2_Nm - torsion.t1_Nm) / torsion.k2
        grid = numpy.concatenate([numpy.linspace(-reach, reach, 1600), numpy.linspace(-2e-4, 2e-4, 400), [-knee2, -knee1, 0.0, knee1, knee2]])
        self.twists = numpy.unique(grid)
        torques = torsion.spring(self.twists)
        self.slopes = (numpy.diff(torques) / numpy.diff(self.twists)).clip(1.0).tolist()
        self.twists, self.torques = self.twists.tolist(), torques.tolist()
        self.stiffness = [level / limit for level, limit in zip(torsion.levels, torsion.yields)]
        self.forces = [0.0] * len(torsion.levels)
        self.rate = torsion.rate() if torsion.rate else None
        self.twist = 0.0

    def _try(self, twist, seconds):
        """(torque, tangent, forces of the elements) at a twist."""
        at = min(max(bisect.bisect_right(self.twists, twist) - 1, 0), len(self.slopes) - 1)
        torque, slope = self.torques[at] + self.slopes[at] * (twist - self.twists[at]), self.slopes[at]
        change, forces = twist - self.twist, []
        for stiffness, level, force in zip(self.stiffness, self.torsion.levels, self.forces):
            trial = force + stiffness * change
            if trial > level:
                trial = level
            elif trial < -level:
                trial = -level
            else:
                slope += stiffness
            torque += trial
            forces.append(trial)
        if self.rate and seconds:
            more, tangent = self.rate.step(change, seconds)
            torque, slope = torque + more, slope + tangent
        return torque, slope, forces

    def to_twist(self, twist, seconds):
        """Goes there; the torque that it takes."""
        torque, _, self.forces = self._try(twist, seconds)
        if self.rate and seconds:
            self.rate.commit(twist - self.twist, seconds)
        self.twist = twist
        return torque

    def to_torque(self, torque, seconds):
        """Goes where the balance holds; that twist. Newton within a bracket that only closes."""
        low, high, guess = self.twists[0], self.twists[-1], self.twist
        for _ in range(40):
            found, slope, _ = self._try(guess, seconds)
            wrong = found - torque
            if wrong > 0.0:
                high = guess
            else:
                low = guess
            if abs(wrong) < 1e-9:
                break
            guess -= wrong / slope
            if not low < guess < high:
                guess = 0.5 * (low + high)
        self.to_twist(guess, seconds)
        return guess


def in_series(torsion, time_s, torque_Nm):
    return sum((law(time_s, torque_Nm) for law in torsion.after), numpy.zeros_like(torque_Nm))


def twist_under(torsion, time_s, torque_Nm):
    """Twist for a measured torque, in steps of the samples: `torque_Nm` includes the transducer's zero."""
    true_Nm = torque_Nm - torsion.torque_zero_Nm
    balance = Balance(torsion, float(numpy.max(numpy.abs(torque_Nm))) + sum(torsion.levels) + 5.0)
    seconds = numpy.diff(time_s, prepend=time_s[0]).tolist()
    twist = numpy.array([balance.to_torque(torque, step_s) for torque, step_s in zip(true_Nm.tolist(), seconds)])
    return twist + in_series(torsion, time_s, true_Nm)


class Power:
    """A torque c |rate|^power, which linear viscosity is with power 1, off a rate below which it is linear."""

    def __init__(self, torque_Nm, rate, power):
        self.torque_Nm, self.unit, self.power = torque_Nm, rate, power

    def step(self, change, seconds):
        relative = change / seconds / self.unit
        size = (relative * relative + 1e-4) ** (0.5 * (self.power - 1.0))
        return self.torque_Nm * relative * size, self.torque_Nm * size * min(self.power, 1.0) / seconds / self.unit

    def commit(self, change, seconds):
        pass


class Logarithm:
    """Friction that grows with the logarithm of the rate (Eyring's activation, asinh about zero)."""

    def __init__(self, torque_Nm, rate):
        self.torque_Nm, self.unit = torque_Nm, rate

    def step(self, change, seconds):
        relative = change / seconds / self.unit
        return (self.torque_Nm * float(numpy.arcsinh(relative)),
                self.torque_Nm / (1.0 + relative * relative) ** 0.5 / seconds / self.unit)

    def commit(self, change, seconds):
        pass


class Maxwell:
    """A spring with a dashpot behind it: the torque of a fast change, which relaxes."""

    def __init__(self, stiffness, tau_s):
        self.stiffness, self.tau_s, self.force = stiffness, tau_s, 0.0

    def step(self, change, seconds):
        part = 1.0 / (1.0 + seconds / self.tau_s)
        return part * (self.force + self.stiffness * change), part * self.stiffness

    def commit(self, change, seconds):
        self.force = self.step(change, seconds)[0]
