# SPDX-License-Identifier: Apache-2.0
"""Dynamic friction laws that really stick. Each gives the share of the Coulomb level, -1 to 1, that a displacement leaves.

All are without a Stribeck fall: what falls with speed is a hidden effect. `step(change, seconds)` moves the contact and returns
the share; a fresh law along a known path gives the same shares again, which is the nominal inverse dynamics of its axis.
"""
import math


class LuGre:
    """dz/dt = v - |v| z / z0, bristles of average deflection z0 (Canudas de Wit 1995); sigma_1 dz/dt damps them.

    With a constant level this is dz/dq, so each step is exact; RungeKutta uses `rate` instead."""

    def __init__(self, deflection, damping_s):
        self.deflection, self.damping_s, self.z = deflection, damping_s, 0.0

    def scaled(self, factor):
        return LuGre(self.deflection * factor, self.damping_s)

    def rate(self, z, speed):
        return (speed - abs(speed) * z) / self.deflection

    def share(self, z, speed):
        return z + self.damping_s * self.rate(z, speed)

    def step(self, change, seconds):
        end = math.copysign(1.0, change)
        before = self.z
        self.z = end + (before - end) * math.exp(-abs(change) / self.deflection)
        return 0.5 * (before + self.z) + self.damping_s * (self.z - before) / seconds


class MaxwellSlip:
    """Generalised Maxwell slip (Al-Bender 2005): elements that stick as springs until each slides at its part of the level. As
    that is constant here, a sliding element is at it and needs no state of its own."""

    def __init__(self, levels, yields):
        self.levels, self.yields = levels, yields
        self.forces = [0.0] * len(levels)

    def scaled(self, factor):
        return MaxwellSlip(self.levels, [factor * value for value in self.yields])

    def step(self, change, seconds):
        total = 0.0
        for i, level in enumerate(self.levels):
            force = self.forces[i] + level / self.yields[i] * change
            self.forces[i] = force = level if force > level else -level if force < -level else force
            total += force
        return total


class Dahl:
    """dF/dq = sigma (1 - F sgn v)^power (Dahl 1968); power 1 would be LuGre's, below 1 yields at once, above 1 slowly."""

    def __init__(self, deflection, power):
        self.deflection, self.power, self.share = deflection, power, 0.0

    def scaled(self, factor):
        return Dahl(self.deflection * factor, self.power)

    def step(self, change, seconds):
        sign = math.copysign(1.0, change)
        left = max(1.0 - sign * self.share, 0.0)
        # The equation for what is left separates: left^(1 - power) changes in proportion to the displacement.
        way, power = abs(change) / self.deflection, self.power
        if left > 0.0:
            base = left ** (1.0 - power) - (1.0 - power) * way
            left = base ** (1.0 / (1.0 - power)) if base > 0.0 else 0.0
        self.share = sign * (1.0 - left)
        return self.share


class BoucWen:
    """dz/dq = (1 - |z|^power (beta sgn(v z) + 1 - beta)) / deflection (Wen 1976); beta above 0.5 has it unload stiffer."""

    def __init__(self, deflection, power, beta):
        self.deflection, self.power, self.beta, self.z = deflection, power, beta, 0.0

    def scaled(self, factor):
        return BoucWen(self.deflection * factor, self.power, self.beta)

    def step(self, change, seconds):
        pieces = max(1, min(int(abs(change) / (0.2 * self.deflection)) + 1, 8))
        part = change / pieces / self.deflection
        for _ in range(pieces):
            loss = abs(self.z) ** self.power * (self.beta * math.copysign(1.0, part * self.z) + 1.0 - self.beta)
            self.z = min(max(self.z + part * (1.0 - loss), -1.0), 1.0)
        return self.z
