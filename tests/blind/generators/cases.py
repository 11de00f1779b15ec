# SPDX-License-Identifier: Apache-2.0
"""Draws one case of a further generator from (generator, seed, case number): the record, and the truth that stays sealed."""
import math
import zlib

import numpy

import draw
from rivals import FREE_PHASE

from .size import Ruler, find_scale, incoherent_sigma, matched_sigma

LEAST_SHARE_LEFT = draw.LEAST_SHARE_LEFT
ATTEMPTS = 40


def _size(ruler, effect, signal):
    whitened = ruler.residual_of(signal)
    return incoherent_sigma(whitened) if effect.by_chance else matched_sigma(whitened)


def _nearest(model, ruler, hidden, signal):
    """(name, sigmas that remain) of the other cause that fits best, each drawn three times and scaled freely; of a free phase two
    draws are fitted together."""
    rng, best = numpy.random.default_rng(0), None
    target = ruler.residual_of(signal).ravel()
    for name in model.rivals:
        if name == hidden.name:
            continue
        drawn = [rival for rival in (model.make_effect(name, rng) for _ in range(3)) if rival]
        others = [other for other in map(model.rival_residual, drawn) if other is not None]
        columns = [ruler.residual_of(other).ravel() for other in others]
        for trial in [columns[:2]] if name in FREE_PHASE else [[column] for column in columns]:
            trial = numpy.stack(trial, axis=1)
            apart = float(numpy.linalg.norm(target - trial @ numpy.linalg.lstsq(trial, target, rcond=None)[0]))
            if best is None or apart < best[1]:
                best = (name, apart)
    return best


class Attempt:
    """One try; `possible` where the drawn details show the drawn effects at the drawn sizes."""

    def __init__(self, rng, generator, situation, causes, wanted_sigma):
        self.model = model = generator.model(rng, causes, wrong_number=situation == "wrong_number")
        self.effects, self.signals, self.likeness, self.rival = [], [], None, None
        self.possible = model.possible
        if not self.possible:
            return
        self.ruler = Ruler(model.regressors(), model.noise)
        drawn = [model.make_outside(rng)] if situation == "outside" else [model.make_effect(name, rng) for name in causes]
        for effect, wanted in zip(drawn, wanted_sigma):
            if not self._scale(effect, wanted):
                self.possible = False
                return
        if len(self.signals) == 2:
            first, second = map(self.ruler.residual_of, self.signals)
            self.likeness = float(abs((first * second).sum()) / numpy.linalg.norm(first) / numpy.linalg.norm(second))
            self.possible = self.likeness < draw.MOST_LIKENESS
        if situation == "one" and not drawn[0].by_chance and wanted_sigma[0] >= draw.CLEAR_SIGMA:
            self.rival = _nearest(model, self.ruler, drawn[0], self.signals[0])
            self.possible = self.rival is None or self.rival[1] > draw.LEAST_APART_SIGMA

    def _scale(self, effect, wanted):
        if effect is None:
            return False

        def size_of(scale):
            signal = self.model.residual([(effect, scale)])
            return None if signal is None else _size(self.ruler, effect, signal)
        scale = find_scale(size_of, effect.first_scale, effect.most_scale, wanted, 0.02, effect.least_scale)
        if scale is None:
            return False
        self.effects.append((effect, scale))
        self.signals.append(self.model.residual([(effect, scale)]))
        return self.ruler.share_left(self.signals[-1]) > LEAST_SHARE_LEFT

    def listed(self):
        return [{"name": effect.name, "law": effect.law, "sigma": _size(self.ruler, effect, signal),
                 "energy_sigma": matched_sigma(self.ruler.residual_of(signal)), "parameters": _plain(effect.describe(scale))}
                for (effect, scale), signal in zip(self.effects, self.signals)]


def _plain(parameters):
    return {name: {"value": float(value), "unit": unit} for name, (value, unit) in parameters.items()}


def _order(rng, request, causes):
    order = [str(name) for name in rng.permutation(causes)]
    return [request.cause] + [name for name in order if name != request.cause] if request.cause else order


def _truth(attempt, generator, seed, number, situation):
    model, listed = attempt.model, attempt.listed()
    truth = {"generator": generator.name, "role": generator.role, "seed": seed, "case": number, "kind": model.kind,
             "situation": situation, "causes": [] if situation == "outside" else listed,
             "nominal": _plain(model.nominal_parameters()), "noise_sd": model.noise.sd, "noise_ar": [model.noise.a1, model.noise.a2],
             "noise_tails": model.noise.tails, "unit": model.unit, "nuisances": sorted(model.nuisances)}
    if situation == "outside":
        truth["outside"] = dict(listed[0], signature=attempt.effects[0][0].signature)
    if attempt.rival:
        truth["nearest_rival"] = {"name": attempt.rival[0], "apart_sigma": attempt.rival[1]}
    if attempt.likeness is not None:
        truth["likeness"] = attempt.likeness
    departure = model.departure()
    if departure is not None:
        truth["departure_sigma"] = float(numpy.linalg.norm(model.noise.whiten(departure)))
    return truth


def draw_case(seed, number, request, generator):
    """The same (generator, seed, number, request) gives the same bytes."""
    stream = zlib.crc32(generator.name.encode())
    first = numpy.random.default_rng([seed, number, stream])
    drawn = str(first.choice(list(draw.SITUATIONS), p=list(draw.SITUATIONS.values())))
    situation = request.situation or ("one" if request.cause else drawn)
    order = _order(first, request, generator.model.causes)
    least = draw.CLEAR_SIGMA if request.clear else draw.LEAST_SIGMA
    wanted = [float(math.exp(first.uniform(math.log(least), math.log(request.most_sigma))))
              for _ in range({"one": 1, "two": 2, "outside": 1}.get(situation, 0))]
    for retry in range(ATTEMPTS):
        causes = {"one": order[:1], "two": [order[0], order[1 + retry // 8 % (len(order) - 1)]]}.get(situation, [])
        rng = numpy.random.default_rng([seed, number, stream, 1 + retry])
        attempt = Attempt(rng, generator, situation, causes, wanted)
        if not attempt.possible:
            continue
        metadata, columns = attempt.model.record(attempt.effects, rng)
        truth = _truth(attempt, generator, seed, number, situation)
        first_column = next(iter(columns.values()))
        truth["samples"] = len(first_column if isinstance(first_column, list) else first_column[0])
        if request.most_samples is None or truth["samples"] <= request.most_samples:
            truth.update(retries=retry, wanted_sigma=wanted)
            return draw.Case(metadata, columns, truth)
    raise draw.NotDrawn("%s: seed %d case %d: no record shows %s (%s) at a plausible size" % (generator.name, seed, number, causes, situation))
