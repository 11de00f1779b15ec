# SPDX-License-Identifier: Apache-2.0
"""Four servo axes, each with a friction law, a controller, an integrator, a way to move and a drive's trace of its own."""
import numpy

from . import reference
from .axis_model import AxisModel
from .controller import Cascade, DisturbanceObserver, DitheredPid
from .friction import BoucWen, Dahl, LuGre, MaxwellSlip


class LugreCascade(AxisModel):
    """LuGre by Runge-Kutta; P-PI cascade with a filtered speed; S-curve moves."""
    integrator, substeps = "runge_kutta", 3

    def path(self, rng, count, step_s, travel):
        return (reference.jerk_limited_moves if rng.random() < 0.6 else reference.chirp)(rng, count, step_s, travel)

    def draw_friction(self, rng):
        # Bristles that are stiffer than the substeps resolve would be the integrator's, not the contact's.
        deflection = max(10.0 ** rng.uniform(-4.3, -3.5) * self.reach, 0.6 * self.top_speed * self.cycle_s / self.substeps)
        damping_s = rng.uniform(0.0, 0.3) * deflection / (0.05 * self.top_speed)
        return lambda: LuGre(deflection, min(damping_s, 2e-4))

    def draw_controller(self, rng):
        speed = rng.uniform(100.0, 180.0)
        gain, filter_hz, forward = speed / rng.uniform(5.0, 8.0), rng.uniform(120.0, 250.0), rng.uniform(0.0, 0.9)
        return lambda axis, path, cycle_s: Cascade(axis, path, cycle_s, gain, speed, filter_hz, forward)

    def draw_trace(self, rng):
        return 0.0, False


class SlipFeedforward(AxisModel):
    """Generalised Maxwell slip; exact for held inputs; the cascade feeds friction forward, often too much or too little of it."""
    integrator = "zero_order_hold"

    def path(self, rng, count, step_s, travel):
        return reference.schroeder_multisine(rng, count, step_s, travel)

    def draw_friction(self, rng):
        count = int(rng.integers(3, 6))
        levels = rng.dirichlet(numpy.full(count, 3.0)).tolist()
        yields = (10.0 ** rng.uniform(-4.5, -3.7) * self.reach * numpy.geomspace(0.4, rng.uniform(2.0, 4.0), count)).tolist()
        return lambda: MaxwellSlip(levels, yields)

    def draw_controller(self, rng):
        speed = rng.uniform(110.0, 180.0)
        gain, share, forward = speed / rng.uniform(5.0, 8.0), rng.uniform(0.5, 1.2), rng.uniform(0.6, 1.0)
        return lambda axis, path, cycle_s: Cascade(axis, path, cycle_s, gain, speed, 200.0, forward, share)

    def draw_trace(self, rng):
        return 0.0, False


class DahlDither(AxisModel):
    """Dahl's friction by Heun; PID with dither; the drive traces position and torque through the same low-pass."""
    integrator = "heun"

    def path(self, rng, count, step_s, travel):
        return (reference.ramps_to_and_fro if rng.random() < 0.6 else reference.chirp)(rng, count, step_s, travel)

    def draw_friction(self, rng):
        deflection, power = 10.0 ** rng.uniform(-4.5, -3.5) * self.reach, float(rng.choice([0.5, 1.5, 2.0]))
        return lambda: Dahl(deflection, power)

    def draw_controller(self, rng):
        bandwidth, share, hertz = rng.uniform(50.0, 90.0), rng.uniform(0.03, 0.15), rng.uniform(0.1, 0.16) * self.rate_hz
        return lambda axis, path, cycle_s: DitheredPid(axis, path, cycle_s, bandwidth, share * axis.coulomb, hertz)

    def draw_trace(self, rng):
        return rng.uniform(0.3, 0.8) / self.rate_hz, False


class BoucWenObserver(AxisModel):
    """Bouc and Wen's friction by leapfrog; disturbance observer; the drive holds means over a sample of position and torque."""
    integrator = "verlet"

    def path(self, rng, count, step_s, travel):
        laws = (reference.jerk_limited_moves, reference.schroeder_multisine, reference.ramps_to_and_fro)
        return laws[int(rng.integers(3))](rng, count, step_s, travel)

    def draw_friction(self, rng):
        deflection, power, beta = 10.0 ** rng.uniform(-4.5, -3.6) * self.reach, rng.uniform(1.0, 3.0), rng.uniform(0.5, 0.8)
        return lambda: BoucWen(deflection, power, beta)

    def draw_controller(self, rng):
        bandwidth, observer = rng.uniform(50.0, 80.0), rng.uniform(60.0, 120.0)
        return lambda axis, path, cycle_s: DisturbanceObserver(axis, path, cycle_s, bandwidth, observer)

    def draw_trace(self, rng):
        return 0.0, True
