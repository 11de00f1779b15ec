# SPDX-License-Identifier: Apache-2.0
"""Noise of the further generators: AR(2), innovations with other tails than the normal ones, channels that share a part."""
import dataclasses
import typing

import numpy

TAILS = ("normal", "student", "laplace", "uniform")


def innovations(rng, tails, shape):
    """Of unit variance."""
    if tails == "student":
        return rng.standard_t(6.0, shape) * numpy.sqrt(4.0 / 6.0)
    if tails == "laplace":
        return rng.laplace(0.0, numpy.sqrt(0.5), shape)
    if tails == "uniform":
        return rng.uniform(-numpy.sqrt(3.0), numpy.sqrt(3.0), shape)
    return rng.standard_normal(shape)


@dataclasses.dataclass
class Noise:
    """x[k] = a1 x[k-1] + a2 x[k-2] + e[k] of standard deviation `sd`; channels are mixed by `mixing`, whose rows have norm 1."""
    sd: float
    a1: float = 0.0
    a2: float = 0.0
    tails: str = "normal"
    mixing: typing.Optional[numpy.ndarray] = None

    def innovation_sd(self):
        """Of a process of unit variance (Yule and Walker)."""
        gain = (1.0 - self.a2) / ((1.0 + self.a2) * ((1.0 - self.a2) ** 2 - self.a1 ** 2))
        return 1.0 / numpy.sqrt(gain)

    def draw(self, rng, shape):
        """Channels x samples."""
        if not self.a1 and not self.a2:
            values = innovations(rng, self.tails, shape)
        else:
            response = [1.0, self.a1]
            while len(response) < 300:
                response.append(self.a1 * response[-1] + self.a2 * response[-2])
            pushed = innovations(rng, self.tails, (shape[0], shape[1] + 300)) * self.innovation_sd()
            values = numpy.stack([numpy.convolve(row, response)[300:300 + shape[1]] for row in pushed])
        if self.mixing is not None:
            values = self.mixing @ values
        return self.sd * values

    def whiten(self, values):
        """Such noise becomes white noise of unit variance in each channel; `values` are channels x samples, or samples of one."""
        scaled = values / self.sd
        if self.mixing is not None and scaled.shape[0] == len(self.mixing):
            scaled = numpy.linalg.solve(self.mixing, scaled)
        return self.whiten_in_time(scaled)

    def whiten_in_time(self, values):
        if not self.a1 and not self.a2:
            return values
        whitened = values.copy()
        whitened[..., 1:] -= self.a1 * values[..., :-1]
        whitened[..., 2:] -= self.a2 * values[..., :-2]
        whitened = whitened / self.innovation_sd()
        whitened[..., :2] = values[..., :2]
        return whitened


def draw_noise(rng, sd, coloured, tails=TAILS):
    """White, or with one or two real poles, or a pair that rings softly."""
    if not coloured:
        return Noise(sd, tails=str(rng.choice(tails)))
    if rng.random() < 0.5:
        first, second = rng.uniform(0.3, 0.75), rng.uniform(-0.3, 0.4)
        return Noise(sd, first + second, -first * second, str(rng.choice(tails)))
    size, angle = rng.uniform(0.3, 0.6), rng.uniform(0.2, 1.2)
    return Noise(sd, 2.0 * size * numpy.cos(angle), -size * size, str(rng.choice(tails)))


def shared_mixing(rng, channels):
    """Each channel has its own part and one that all share (the floor, the supply)."""
    share = rng.uniform(0.2, 0.7, channels)
    mixing = numpy.diag(numpy.sqrt(1.0 - share ** 2)) if channels > 1 else numpy.eye(1)
    if channels > 1:
        # The common part is the first channel's own noise as well: as many sources as channels, and a matrix that inverts.
        mixing[1:, 0] += share[1:]
        mixing[0, 0] = 1.0
    return mixing / numpy.linalg.norm(mixing, axis=1, keepdims=True)
