# SPDX-License-Identifier: Apache-2.0
"""Draws one case from (seed, case number): the record, and the truth that stays sealed."""
import dataclasses
import math

import numpy

import hysteresis
import motion
import nuisance
import rivals
import transmission_error
import vibration
from effect import Ruler, predicted_sigma, scale_for

EXPERIMENTS = {"transmission_error": (transmission_error.TransmissionError, transmission_error.CAUSES, 0.28),
               "hysteresis": (hysteresis.Hysteresis, hysteresis.CAUSES, 0.27),
               "motion": (motion.Motion, motion.CAUSES, 0.28),
               "vibration": (vibration.Vibration, vibration.CAUSES, 0.17)}
SITUATIONS = {"one": 0.55, "null": 0.15, "two": 0.12, "outside": 0.10, "wrong_number": 0.08}
LEAST_SIGMA, MOST_SIGMA, CLEAR_SIGMA = 3.0, 60.0, 5.0
LEAST_SHARE_LEFT = 0.03  # an effect that the nominal model mimics to 97 % is not asked for
LEAST_APART_SIGMA = 2.0  # between a clear effect and the best fit of any other cause
MOST_LIKENESS = 0.6  # of two effects in one record
ATTEMPTS = 200


@dataclasses.dataclass
class Request:
    """What the command line fixes; None: drawn."""
    kind: str = None
    cause: str = None
    situation: str = None
    clear: bool = False
    most_sigma: float = MOST_SIGMA
    most_samples: int = None  # longer records are not drawn


@dataclasses.dataclass
class Case:
    metadata: dict
    columns: dict
    truth: dict


def _situation(rng, request):
    drawn = str(rng.choice(list(SITUATIONS), p=list(SITUATIONS.values())))
    if request.situation:
        return request.situation
    return "one" if request.cause else drawn


def _kind(rng, request):
    weights = numpy.array([weight for _, _, weight in EXPERIMENTS.values()])
    drawn = str(rng.choice(list(EXPERIMENTS), p=weights / weights.sum()))
    if request.kind:
        return request.kind
    if request.cause:
        homes = [kind for kind, (_, causes, _) in EXPERIMENTS.items() if request.cause in causes]
        return drawn if drawn in homes else homes[0]
    return drawn


def _causes(rng, request, kind):
    order = [str(name) for name in rng.permutation(EXPERIMENTS[kind][1])]
    if request.cause:
        order = [request.cause] + [name for name in order if name != request.cause]
    return order


def _picked(order, situation, retry):
    """A pair that does not come about is given up for the next partner: some causes are too alike in any record."""
    if situation == "two":
        return [order[0], order[1 + retry // 20 % (len(order) - 1)]]
    return order[:1] if situation == "one" else []


def _sigma(rng, request):
    least = CLEAR_SIGMA if request.clear else LEAST_SIGMA
    return float(math.exp(rng.uniform(math.log(least), math.log(request.most_sigma))))


class NotDrawn(RuntimeError):
    """No try of many gave a record that can show what was asked for."""


class Attempt:
    """One try at a case; it fails where the drawn details cannot show the drawn effect at the drawn size."""

    def __init__(self, rng, kind, situation, causes, wanted_sigma):
        self.rng = rng
        self.wanted_sigma = wanted_sigma
        self.rival = None
        self.nuisances = nuisance.choose(rng, kind, causes)
        self.experiment = EXPERIMENTS[kind][0](rng, causes, self.nuisances, wrong_number=situation == "wrong_number")
        self.keep = nuisance.kept_samples(rng, self.experiment.sample_count(), self.nuisances)
        self.quantum = None
        if "quantisation" in self.nuisances:
            self.quantum = rng.uniform(0.5, 1.5) * self.experiment.noise_sd
            self.experiment.noise_sd = math.hypot(self.experiment.noise_sd, self.quantum / math.sqrt(12.0))
        self.ruler = Ruler(self.experiment.regressors()[self.keep], self.experiment.noise_sd, self.experiment.rho)
        self.effects = []
        if situation == "outside":
            self.effects = [self.experiment.make_outside(rng)]
        else:
            self.effects = [self.experiment.make_effect(name, rng) for name in causes]
        self.possible = all(self.effects)
        self.scales = []
        if self.possible:
            self._size()
        if self.possible and situation == "one":
            self.rival = rivals.nearest(self, EXPERIMENTS[kind][1])
            # Below five sigma nobody is asked for the right name each time; above, the record must allow it.
            decidable = self.rival is None or self.rival[1] > LEAST_APART_SIGMA or wanted_sigma[0] < CLEAR_SIGMA
            self.possible = self.possible and decidable

    def respond(self, effects):
        return self.experiment.respond(effects)[:, self.keep]

    def _size(self):
        # The ruler sees the kept samples only, so the experiment is asked through `respond` above.
        self.signals = []
        nominal = self.respond([])
        for effect, wanted in zip(self.effects, self.wanted_sigma):
            scale = scale_for(self, effect, wanted)
            if scale is None:
                self.possible = False
                return
            signal = self.respond([(effect, scale)]) - nominal
            self.possible = self.possible and self.ruler.share_left(signal) > LEAST_SHARE_LEFT
            self.scales.append(scale)
            self.signals.append(self.ruler.residual_of(signal))
        if len(self.signals) == 2:
            first, second = self.signals
            self.likeness = float(abs((first * second).sum()) / numpy.linalg.norm(first) / numpy.linalg.norm(second))
            self.possible = self.possible and self.likeness < MOST_LIKENESS

    def measured(self):
        sized = list(zip(self.effects, self.scales))
        response = self.experiment.respond(sized)
        sd = getattr(self.experiment, "response_noise_sd", lambda: None)() or self._added_noise_sd()
        response = response + nuisance.noise(self.rng, response.shape, sd, self.experiment.rho)
        if "outliers" in self.nuisances:
            nuisance.add_spikes(self.rng, response, self.experiment.noise_sd)
        return response

    def _added_noise_sd(self):
        rounding_sd = self.quantum / math.sqrt(12.0) if self.quantum else 0.0
        return math.sqrt(self.experiment.noise_sd ** 2 - rounding_sd ** 2)


def _listed(parameters):
    return {name: {"value": float(value), "unit": unit} for name, (value, unit) in parameters.items()}


def _truth(attempt, seed, number, situation):
    experiment = attempt.experiment
    causes = []
    for effect, scale, signal in zip(attempt.effects, attempt.scales, attempt.signals if attempt.effects else []):
        causes.append({"name": effect.name, "sigma": predicted_sigma(attempt, effect, signal),
                       "energy_sigma": float(numpy.linalg.norm(signal)), "parameters": _listed(effect.describe(scale))})
    truth = {"seed": seed, "case": number, "kind": experiment.kind, "situation": situation,
             "causes": [] if situation == "outside" else causes,
             "nominal": _listed(experiment.nominal_parameters()),
             "noise_sd": experiment.noise_sd, "unit": experiment.unit, "noise_ar1": experiment.rho,
             "nuisances": attempt.nuisances, "samples": int(attempt.keep.sum())}
    if situation == "outside":
        truth["outside"] = dict(causes[0], signature=attempt.effects[0].signature)
    if attempt.rival:
        truth["nearest_rival"] = {"name": attempt.rival[0], "apart_sigma": attempt.rival[1]}
    if len(causes) == 2:
        truth["likeness"] = attempt.likeness
    return truth


def draw_attempt(seed, number, request=Request()):
    """(the attempt that came about, its situation, how many had not)"""
    first = numpy.random.default_rng([seed, number])
    situation, kind = _situation(first, request), _kind(first, request)
    order = _causes(first, request, kind)
    wanted_sigma = [_sigma(first, request) for _ in range({"one": 1, "two": 2, "outside": 1}.get(situation, 0))]
    for retry in range(ATTEMPTS):
        # What is asked for stays; only the details are drawn again, so hard causes are as frequent as easy ones.
        causes = _picked(order, situation, retry)
        attempt = Attempt(numpy.random.default_rng([seed, number, 1 + retry]), kind, situation, causes, wanted_sigma)
        long = request.most_samples is not None and attempt.keep.sum() > request.most_samples
        if attempt.possible and not long:
            return attempt, situation, retry
    raise NotDrawn("seed %d case %d: no record shows %s (%s) at a plausible size" % (seed, number, causes, kind))


def draw_case(seed, number, request=Request()):
    """The same (seed, number, request) gives the same bytes, whatever else is drawn."""
    attempt, situation, retry = draw_attempt(seed, number, request)
    metadata, columns = attempt.experiment.record(attempt.measured(), attempt.keep, attempt.rng, attempt.quantum)
    truth = _truth(attempt, seed, number, situation)
    truth["retries"] = retry
    truth["wanted_sigma"] = attempt.wanted_sigma
    return Case(metadata, columns, truth)
