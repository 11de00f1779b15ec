# SPDX-License-Identifier: Apache-2.0
"""Position controllers, called once a control cycle with the measured position; each returns the torque to command."""
import math


class Cascade:
    """P position loop, PI speed loop; the speed is the difference of positions through a low-pass. Acceleration and friction
    may be fed forward (Armstrong 1994 has the usual forms)."""

    def __init__(self, axis, reference, cycle_s, position_gain, speed_rad_per_s, filter_hz, acceleration_share=0.0,
                 friction_share=0.0):
        self.reference, self.cycle_s = reference, cycle_s
        self.position_gain = position_gain
        self.speed_gain = axis.inertia * speed_rad_per_s
        self.integral_gain = self.speed_gain * speed_rad_per_s / 5.0
        self.keep = math.exp(-2.0 * math.pi * filter_hz * cycle_s)
        self.inertia_share = acceleration_share * axis.inertia
        self.friction_share = friction_share * axis.coulomb
        self.soft_speed = 0.01 * max(abs(b - a) / cycle_s for a, b in zip(reference, reference[1:]))
        self.speed = self.integral = self.last = 0.0

    def update(self, k, measured):
        ahead = self.reference[min(k + 1, len(self.reference) - 1)]
        here, behind = self.reference[k], self.reference[max(k - 1, 0)]
        self.speed = self.keep * self.speed + (1.0 - self.keep) * (measured - self.last) / self.cycle_s
        self.last = measured
        wanted = (ahead - behind) / (2.0 * self.cycle_s)
        error = wanted + self.position_gain * (here - measured) - self.speed
        self.integral += self.integral_gain * error * self.cycle_s
        acceleration = (ahead - 2.0 * here + behind) / self.cycle_s ** 2
        return (self.speed_gain * error + self.integral + self.inertia_share * acceleration +
                self.friction_share * math.tanh(wanted / self.soft_speed))


class DitheredPid:
    """PID on the position with a filtered derivative, and a small alternating torque that keeps the contact from sticking."""

    def __init__(self, axis, reference, cycle_s, bandwidth_rad_per_s, dither_Nm, dither_hz):
        self.reference, self.cycle_s = reference, cycle_s
        self.stiffness = axis.inertia * bandwidth_rad_per_s ** 2
        self.damping = 2.0 * 0.9 * axis.inertia * bandwidth_rad_per_s
        self.integral_gain = self.stiffness * bandwidth_rad_per_s / 6.0
        self.dither_Nm, self.dither_hz = dither_Nm, dither_hz
        self.inertia = axis.inertia
        self.keep = math.exp(-2.0 * math.pi * 180.0 * cycle_s)
        self.slope = self.integral = self.last = 0.0

    def update(self, k, measured):
        error = self.reference[k] - measured
        self.slope = self.keep * self.slope + (1.0 - self.keep) * (error - self.last) / self.cycle_s
        self.last = error
        self.integral += self.integral_gain * error * self.cycle_s
        ahead, behind = self.reference[min(k + 1, len(self.reference) - 1)], self.reference[max(k - 1, 0)]
        acceleration = (ahead - 2.0 * self.reference[k] + behind) / self.cycle_s ** 2
        dither = self.dither_Nm * math.sin(2.0 * math.pi * self.dither_hz * k * self.cycle_s)
        return self.stiffness * error + self.damping * self.slope + self.integral + 0.8 * self.inertia * acceleration + dither


class DisturbanceObserver:
    """PD about the fed-forward acceleration; what the nominal inertia does not explain of the speed is filtered and taken off
    the command (Ohnishi 1987)."""

    def __init__(self, axis, reference, cycle_s, bandwidth_rad_per_s, observer_rad_per_s):
        self.reference, self.cycle_s, self.inertia = reference, cycle_s, axis.inertia
        self.stiffness = axis.inertia * bandwidth_rad_per_s ** 2
        self.damping = 2.0 * axis.inertia * bandwidth_rad_per_s
        self.observer = observer_rad_per_s
        self.keep = math.exp(-observer_rad_per_s * cycle_s)
        self.keep_speed = math.exp(-2.0 * math.pi * 150.0 * cycle_s)
        self.speed = self.last = self.filtered = self.torque = 0.0

    def update(self, k, measured):
        self.speed = self.keep_speed * self.speed + (1.0 - self.keep_speed) * (measured - self.last) / self.cycle_s
        self.last = measured
        # d = LP(u + g J v) - g J v, which needs no acceleration.
        momentum = self.observer * self.inertia * self.speed
        self.filtered = self.keep * self.filtered + (1.0 - self.keep) * (self.torque + momentum)
        ahead, behind = self.reference[min(k + 1, len(self.reference) - 1)], self.reference[max(k - 1, 0)]
        acceleration = (ahead - 2.0 * self.reference[k] + behind) / self.cycle_s ** 2
        speed_error = (ahead - behind) / (2.0 * self.cycle_s) - self.speed
        self.torque = (self.stiffness * (self.reference[k] - measured) + self.damping * speed_error +
                       self.inertia * acceleration + self.filtered - momentum)
        return self.torque
