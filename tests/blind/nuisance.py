# SPDX-License-Identifier: Apache-2.0
"""What makes a record awkward without being an effect: autoregressive noise, spikes, gaps, rounding."""
import math

import numpy

from effect import recursion

COMMON = ("outliers", "coloured_noise", "quantisation", "missing_columns", "short_record", "other_rate")
# Gaps make no sense at a fixed sample rate; only loggers of axes jitter.
ALLOWED = {"transmission_error": COMMON + ("gap",), "hysteresis": COMMON + ("gap",),
           "motion": COMMON + ("gap", "jitter"), "vibration": COMMON}
# Slow noise looks like what moves slowly: such a record would not let anyone decide.
NOT_COLOURED = ("thermal_drift", "thermal_friction_drift", "creep", "torsional_resonance", "output_eccentricity")


def choose(rng, kind, causes):
    count = int(rng.choice([0, 1, 2], p=[0.4, 0.4, 0.2]))
    allowed = [name for name in ALLOWED[kind]
               if name != "coloured_noise" or not any(cause in NOT_COLOURED for cause in causes)]
    return [str(name) for name in sorted(rng.choice(allowed, count, replace=False))]


def kept_samples(rng, count, nuisances):
    """False in the gap: 1 to 5 % of the record somewhere in its middle."""
    keep = numpy.ones(count, dtype=bool)
    if "gap" in nuisances:
        length = max(int(count * rng.uniform(0.01, 0.05)), 1)
        start = int(rng.integers(count // 10, count - length - count // 10))
        keep[start:start + length] = False
    return keep


def noise(rng, shape, noise_sd, rho):
    """White, or AR(1) of the same standard deviation."""
    values = rng.standard_normal(shape) * noise_sd
    if rho == 0.0:
        return values
    share = math.sqrt(1.0 - rho * rho)
    values[:, 1:] *= share
    return numpy.stack([recursion(row, rho) for row in values])


def add_spikes(rng, values, noise_sd):
    """Single samples far off, 0.1 to 0.5 % of all, both signs; not the first, which sets the zero of the record."""
    for row in values:
        count = max(int(len(row) * rng.uniform(0.001, 0.005)), 1)
        where = 1 + rng.choice(len(row) - 1, count, replace=False)
        row[where] += rng.choice([-1.0, 1.0], count) * rng.uniform(8.0, 30.0, count) * noise_sd
