# SPDX-License-Identifier: Apache-2.0
"""What a hidden effect is; its matched-filter size in sigmas; the scale that gives it a wanted size."""
import dataclasses
import math
import typing

import numpy


@dataclasses.dataclass
class Effect:
    """One effect with everything drawn but its size. `act` belongs to the kind, which knows how to apply it."""
    name: str
    act: typing.Callable
    describe: typing.Callable  # scale -> {parameter: (value, unit)}
    first_scale: float
    most_scale: float  # beyond it the effect is no longer physically plausible
    signature: typing.Optional[dict] = None  # only effects outside the list: how a good program would point at them
    tolerance: float = 0.005  # of the size that is asked for
    least_scale: float = 0.0  # below it the effect is not physically plausible either
    # Independent search locations (orders, times, resonances) of which it may have any, for attainable.py alone.
    ln_search_locations: float = 0.0
    # What of it is no chance, and has a size to a matched filter.
    predicted: typing.Optional[typing.Callable] = None  # act() without what is chance, where not all of it can be predicted
    driven_mode: typing.Optional[tuple] = None  # (Hz, damping ratio) of what noise drives: its spectrum is all that is known


def recursion(push, keep):
    """y[k] = keep y[k-1] + push[k], by doubling strides instead of a loop over the samples."""
    out, stride = push.copy(), 1
    while stride < len(out) and keep > 1e-18:
        ahead = keep * out[:-stride]
        out[stride:] += ahead
        keep, stride = keep * keep, 2 * stride
    return out


def whiten(values, rho):
    """AR(1) noise of unit variance becomes white noise of unit variance; `values` end with the axis of the samples."""
    if rho == 0.0:
        return values
    whitened = numpy.empty_like(values)
    whitened[..., 0] = values[..., 0]
    whitened[..., 1:] = (values[..., 1:] - rho * values[..., :-1]) / math.sqrt(1.0 - rho * rho)
    return whitened


class Ruler:
    """Measures in sigmas what is left of a signal when the nominal model has taken what it can."""

    def __init__(self, regressors, noise_sd, rho):
        self.noise_sd = noise_sd
        self.rho = rho
        columns = whiten(regressors.T, rho)
        columns = columns / numpy.linalg.norm(columns, axis=1, keepdims=True).clip(1e-300)
        left, singular, _ = numpy.linalg.svd(columns.T, full_matrices=False)
        self.basis = left[:, singular > 1e-9 * singular[0]]

    def residual_of(self, signal):
        """Whitened `signal` (channels x samples, response units) in noise sigmas, off the nominal columns."""
        scaled = whiten(signal, self.rho) / self.noise_sd
        return scaled - (scaled @ self.basis) @ self.basis.T

    def sigma(self, signal):
        return float(numpy.linalg.norm(self.residual_of(signal)))

    def share_left(self, signal):
        """0: the nominal model mimics the signal fully; 1: not at all."""
        raw = float(numpy.linalg.norm(whiten(signal, self.rho) / self.noise_sd))
        return self.sigma(signal) / raw if raw > 0.0 else 0.0


def nats_of_driven_mode(values, rate_hz, natural_hz, damping_ratio):
    """Gain by the best level of a resonance's spectrum; `values` in sigmas of white noise, which is added on average."""
    power = numpy.abs(numpy.fft.rfft(values)) ** 2 / len(values)
    hertz = numpy.fft.rfftfreq(len(values), 1.0 / rate_hz)
    line = 1.0 / ((hertz ** 2 - natural_hz ** 2) ** 2 + (2.0 * damping_ratio * natural_hz * hertz) ** 2)
    levels = [level * line * power.sum() / line.sum() for level in numpy.geomspace(0.1, 10.0, 9)]
    return max(float(((1.0 + power) * level / (1.0 + level) - numpy.log1p(level)).sum()) for level in levels)


def predicted_sigma(attempt, effect, signal):
    """Size of a whitened `signal` to a filter that is matched to all of the effect that is no chance: its even impulses,
    its spectrum, or (most effects) all of it."""
    if effect.predicted:
        template = attempt.ruler.residual_of(effect.predicted(1.0)[:, attempt.keep])
        return abs(float((signal * template).sum())) / float(numpy.linalg.norm(template))
    if effect.driven_mode:
        gains = attempt.experiment.gains
        nats = nats_of_driven_mode(gains @ signal / numpy.linalg.norm(gains), attempt.experiment.rate_hz, *effect.driven_mode)
        return math.sqrt(max(0.0, 2.0 * nats))
    return float(numpy.linalg.norm(signal))


def scale_for(attempt, effect, wanted_sigma):
    """The scale at which `effect`, alone, has `wanted_sigma`; None where no plausible scale reaches it."""
    nominal = attempt.respond([])

    def sigma_at(scale):
        return predicted_sigma(attempt, effect, attempt.ruler.residual_of(attempt.respond([(effect, scale)]) - nominal))

    low, high = 0.0, effect.most_scale
    scale = min(effect.first_scale, effect.most_scale)
    for step in range(25):
        sigma = sigma_at(scale)
        if not math.isfinite(sigma) or sigma <= 0.0:
            low, scale = scale, 2.0 * scale
        elif abs(sigma / wanted_sigma - 1.0) < effect.tolerance:
            return scale if scale >= effect.least_scale else None
        else:
            if sigma < wanted_sigma:
                low = scale
            else:
                high = scale
            # Most effects are nearly proportional to their scale; where they are not, halving the bracket takes over.
            guess = scale * wanted_sigma / sigma
            inside = low < guess < high
            scale = guess if inside and step < 8 else 0.5 * (low + high)
        if low >= 0.999 * effect.most_scale or scale > effect.most_scale or high <= effect.least_scale:
            return None
    return None
