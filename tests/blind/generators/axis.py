# SPDX-License-Identifier: Apache-2.0
"""A servo axis that is simulated in closed loop: encoder, controller, drive, motor with a friction that sticks, maybe a second
inertia. What it needed is compared with the inverse dynamics of the nominal model along the path that it went.

Between two control cycles the torque is held. The balance of momentum over a cycle is then exact:
torque - inertia * change of speed / cycle - viscous * mean speed - mean friction - offset = mean of what is hidden.
"""
import dataclasses
import math
import typing

import numpy


@dataclasses.dataclass
class Axis:
    inertia: float
    viscous: float
    coulomb: float
    offset: float
    friction: typing.Callable  # () -> a fresh law of friction.py
    integrator: str  # runge_kutta (LuGre's bristles among its states), heun, zero_order_hold or verlet
    cycle_s: float
    substeps: int


@dataclasses.dataclass
class Hidden:
    """What effects add to the axis."""
    terms: tuple = ()  # (time_s, position, speed, acceleration, friction share) -> torque that it takes
    late_s: float = 0.0  # the commanded torque acts after a dead time
    lags_s: tuple = ()  # and through first-order lags
    coupling: typing.Optional[object] = None


@dataclasses.dataclass
class Encoder:
    step: float
    wave: float  # interpolation error: amplitude
    period: float  # and period
    phase: float

    def read(self, position):
        seen = position + self.wave * math.sin(2.0 * math.pi * position / self.period + self.phase)
        return self.step * math.floor(seen / self.step + 0.5)


@dataclasses.dataclass
class Run:
    """On the grid of control cycles, with one position more than torques; `fine` has all substeps."""
    position: numpy.ndarray
    speed: numpy.ndarray
    torque: numpy.ndarray
    fine: list


def _advance(axis, law, net, state, torque, step_s):
    """One substep. `net(position, speed, share)` is what the hidden effects take; state: position, speed, share of friction."""
    q, v, share = state
    inertia, viscous, coulomb = axis.inertia, axis.viscous, axis.coulomb
    if axis.integrator == "runge_kutta":
        def rates(q1, v1, z1):
            s = law.share(z1, v1)
            return v1, (torque - net(q1, v1, s) - viscous * v1 - coulomb * s) / inertia, law.rate(z1, v1)
        z, half = law.z, 0.5 * step_s
        a1, b1, c1 = rates(q, v, z)
        a2, b2, c2 = rates(q + half * a1, v + half * b1, z + half * c1)
        a3, b3, c3 = rates(q + half * a2, v + half * b2, z + half * c2)
        a4, b4, c4 = rates(q + step_s * a3, v + step_s * b3, z + step_s * c3)
        sixth = step_s / 6.0
        law.z = min(max(z + sixth * (c1 + 2.0 * (c2 + c3) + c4), -1.0), 1.0)
        v_end = v + sixth * (b1 + 2.0 * (b2 + b3) + b4)
        return q + sixth * (a1 + 2.0 * (a2 + a3) + a4), v_end, law.share(law.z, v_end)
    if axis.integrator == "zero_order_hold":  # exact for what is linear, friction and effects held over the substep
        driven = torque - net(q, v, share) - coulomb * share
        keep = math.exp(-viscous * step_s / inertia)
        v_end = keep * v + (1.0 - keep) / viscous * driven
        change = driven / viscous * step_s + (v - driven / viscous) * (1.0 - keep) * inertia / viscous
        # The contact's spring would be explicit: the displacement of the end speed keeps it from gaining energy.
        change = 0.5 * (change + v_end * step_s)
    elif axis.integrator == "heun":
        first = (torque - net(q, v, share) - viscous * v - coulomb * share) / inertia
        guess = v + step_s * first
        second = (torque - net(q + step_s * v, guess, share) - viscous * guess - coulomb * share) / inertia
        v_end = v + 0.5 * step_s * (first + second)
        change = step_s * v_end
    else:  # leapfrog of Verlet
        v_end = v + step_s * (torque - net(q, v, share) - viscous * v - coulomb * share) / inertia
        change = step_s * v_end
    return q + change, v_end, law.step(change, step_s)


def simulate(axis, reference, encoder, controller, hidden):
    """None where the loop does not hold the axis."""
    law, step_s = axis.friction(), axis.cycle_s / axis.substeps
    coupling = hidden.coupling.begin(axis) if hidden.coupling else None
    moved = dataclasses.replace(axis, inertia=axis.inertia * (1.0 - coupling.share),
                                coulomb=axis.coulomb * (1.0 - coupling.friction_share)) if coupling else axis
    terms, lags = hidden.terms, [0.0] * len(hidden.lags_s)
    gains = [1.0 - math.exp(-step_s / lag_s) for lag_s in hidden.lags_s]
    q = v = share = acceleration = 0.0
    far = 3.0 * float(numpy.max(numpy.abs(reference))) + 1e-9
    references = reference.tolist()
    position, speed, torque, fine = [q], [v], [], [q]
    late = hidden.late_s / axis.cycle_s
    for k in range(len(references)):
        command = controller.update(k, encoder.read(q))
        torque.append(command)
        for i in range(axis.substeps):
            time_s = (k * axis.substeps + i) * step_s
            acting = command
            if late:
                at = math.floor(k + (i + 0.5) / axis.substeps - late)
                acting = torque[at] if at >= 0 else 0.0
            for n, gain in enumerate(gains):
                lags[n] += gain * (acting - lags[n])
                acting = lags[n]
            pull = coupling.pull(q, v, step_s) if coupling else 0.0

            def net(q1, v1, share1):
                taken = pull + axis.offset
                for term in terms:
                    taken += term(time_s, q1, v1, acceleration, share1)
                return taken
            before = v
            q, v, share = _advance(moved, law, net, (q, v, share), acting, step_s)
            acceleration = (v - before) / step_s
            fine.append(q)
        if not abs(q) < far:
            return None
        position.append(q)
        speed.append(v)
    return Run(numpy.array(position), numpy.array(speed), numpy.array(torque), fine)


def friction_along(law, fine, substeps, step_s):
    """Mean share of friction in each control cycle, by a fresh law along the path."""
    shares = [law.step(after - before, step_s) if after != before else 0.0 for before, after in zip(fine, fine[1:])]
    return numpy.array(shares).reshape(-1, substeps).mean(axis=1)


def nominal_columns(axis, run, factor=1.0):
    """Inertia's, viscous friction's, Coulomb friction's and the offset's direction in each control cycle."""
    shares = friction_along(axis.friction().scaled(factor), run.fine, axis.substeps, axis.cycle_s / axis.substeps)
    return numpy.stack([numpy.diff(run.speed) / axis.cycle_s, numpy.diff(run.position) / axis.cycle_s, shares,
                        numpy.ones_like(shares)], axis=1)


class Coupling:
    """A part of the inertia behind a spring, or behind a gap: `law(lead, closing)` is the torque per unit of its inertia."""

    def __init__(self, share, law, friction_share=0.0):
        self.share, self.law, self.friction_share = share, law, friction_share

    def begin(self, axis):
        self.inertia, self.drag = self.share * axis.inertia, self.friction_share * axis.coulomb
        self.position = self.speed = 0.0
        return self

    def pull(self, q, v, step_s):
        """Advances the load by a substep (semi-implicit Euler) and returns the torque that it takes from the motor."""
        torque = self.inertia * self.law(q - self.position, v - self.speed)
        free = self.speed + step_s * torque / self.inertia
        # Dry friction stops the load at most.
        stop = step_s * self.drag / self.inertia
        self.speed = free - min(max(free, -stop), stop)
        self.position += step_s * self.speed
        return torque
