# SPDX-License-Identifier: Apache-2.0
"""How large an effect is, in sigmas: what its record leaves of the nominal model, whitened, off the nominal parameters' directions.

The generators give a *residual*: the noise-free record less the nominal model (true parameters) at the record's own inputs. For an
axis in closed loop these are the path that it went and the torque that was reported, at a reference that is held; without an effect
the residual is nothing. Of an effect with chance in it only the power in each cell of time and frequency is known to an analyst.
"""
import math

import numpy

CELL = 64  # samples


class Ruler:
    def __init__(self, regressors, noise):
        self.noise = noise
        columns = noise.whiten_in_time(regressors.T / numpy.linalg.norm(regressors, axis=0)[:, numpy.newaxis].clip(1e-300))
        columns = columns / numpy.linalg.norm(columns, axis=1, keepdims=True).clip(1e-300)
        left, singular, _ = numpy.linalg.svd(columns.T, full_matrices=False)
        self.basis = left[:, singular > 1e-9 * singular[0]]

    def residual_of(self, signal):
        """Whitened `signal` (channels x samples), off the nominal columns."""
        scaled = self.noise.whiten(signal)
        return scaled - (scaled @ self.basis) @ self.basis.T

    def share_left(self, signal):
        """0: the nominal model mimics the signal fully; 1: not at all."""
        raw = float(numpy.linalg.norm(self.noise.whiten(signal)))
        return float(numpy.linalg.norm(self.residual_of(signal))) / raw if raw > 0.0 else 0.0


def matched_sigma(whitened):
    return float(numpy.linalg.norm(whitened))


def incoherent_sigma(whitened):
    """sqrt(2 nats) that the powers of cells of time and frequency are worth in white noise; at most `matched_sigma`."""
    cells = whitened.shape[1] // CELL
    cut = whitened[:, :cells * CELL].reshape(whitened.shape[0], cells, CELL)
    power = (numpy.abs(numpy.fft.rfft(cut, axis=2)) ** 2 / CELL).sum(axis=0)
    # What two neighbours in time and frequency have in common is all that anybody can estimate.
    power = 0.5 * (power[:, 1:] + power[:, :-1])
    return math.sqrt(max(2.0 * float((power - numpy.log1p(power)).sum()), 0.0))


def find_scale(size_of, first, most, wanted, tolerance=0.01, least=0.0):
    """The scale at which `size_of(scale)` is `wanted`; None where none between `least` and `most` is."""
    low, high, scale = 0.0, most, min(first, most)
    for step in range(22):
        size = size_of(scale)
        if size is None:  # the axis does not survive it
            high, scale = scale, 0.5 * (low + scale)
            continue
        if abs(size / wanted - 1.0) < tolerance:
            return scale if scale >= least else None
        if size < wanted:
            low = scale
        else:
            high = scale
        guess = scale * (wanted / size if size > 0.0 else 4.0)
        guess = min(guess, most)
        scale = guess if low < guess <= high and step < 7 else 0.5 * (low + high)
        if low >= 0.999 * most or high <= least or high - low < 1e-6 * high:
            return None
    return None
