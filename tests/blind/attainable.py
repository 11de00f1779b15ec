#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What share of single effects of 5 sigma and up the best analyst would name, beside the share that was named.

The best analyst knows the generator's formulae, but not its draws: it compares likelihoods and finds something in one of
200 clean records. By cause: the mean probability that the effect's gain in log-likelihood, with its scatter, pays for the
search locations of vibration at which it might have been and for that caution, and that it is ahead of its nearest rival (which may
be named beside it; a bearing has to be clearly ahead of the line that its strongest harmonic is). An estimate to half a
sigma or so; search locations of other kinds (windows, times of a jump) are not charged, and rivals are at most so far away.
"""
import argparse
import collections
import json
import math

import numpy

import draw
from effect import predicted_sigma

FOUND_BY_CHANCE, WRONG_NAMES = 0.005, 0.01
# A train may have the line that is seen as any of its harmonics, with any resonance and change that leaves the others as weak.
LN_TRAINS_OF_A_LINE = math.log(200.0)


def normal(x):
    return 0.5 * (1.0 + math.erf(x / math.sqrt(2.0)))


def probability(nats, asked):
    """Of a gain of so many nats on average, whose square root of twice scatters by one, to reach what is asked."""
    return normal(math.sqrt(2.0 * nats) - math.sqrt(2.0 * asked)) if nats > 0.0 else 0.0


def strongest_line(signal, angle_rad):
    """Half the square of the size of the strongest line over angle in whitened channels."""
    even = numpy.linspace(angle_rad[0], angle_rad[-1], len(angle_rad))
    over_angle = numpy.stack([numpy.interp(even, angle_rad, channel) for channel in signal])
    power = (numpy.abs(numpy.fft.rfft(over_angle, 4 * len(even))) ** 2).sum(axis=0)
    return float(power.max()) / len(even)


def probability_of_name(attempt, causes):
    effect, signal, experiment = attempt.effects[0], attempt.signals[0], attempt.experiment
    nats = 0.5 * predicted_sigma(attempt, effect, signal) ** 2
    found = probability(nats, effect.ln_search_locations + math.log(causes / FOUND_BY_CHANCE))
    if effect.predicted:
        line = strongest_line(signal, experiment.angle_rad[attempt.keep])
        return found * probability(nats - line, LN_TRAINS_OF_A_LINE + math.log(1.0 / WRONG_NAMES))
    # Ahead by half the square of the distance on average; that scatters by the distance.
    apart = attempt.rival[1] if attempt.rival else math.inf
    return min(found, normal(0.5 * apart))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--cases", type=int, default=100)
    parser.add_argument("--kind", choices=list(draw.EXPERIMENTS))
    parser.add_argument("--cause")
    parser.add_argument("--clear", action="store_true")
    parser.add_argument("--most-sigma", type=float, default=draw.MOST_SIGMA)
    parser.add_argument("--results", nargs="*", default=[], help="results.jsonl of tests/blind/run with the same options")
    arguments = parser.parse_args()
    named = {}
    for path in arguments.results:
        with open(path, encoding="utf-8") as lines:
            named.update((result["case"], result["status"] == "right") for result in map(json.loads, lines))
    request = draw.Request(arguments.kind, arguments.cause, None, arguments.clear, arguments.most_sigma)
    chances, hits = collections.defaultdict(list), collections.defaultdict(list)
    for number in range(arguments.cases):
        try:
            attempt, situation, _ = draw.draw_attempt(arguments.seed, number, request)
        except draw.NotDrawn:
            continue
        if situation != "one" or attempt.wanted_sigma[0] < draw.CLEAR_SIGMA or (named and number not in named):
            continue
        chance = probability_of_name(attempt, len(draw.EXPERIMENTS[attempt.experiment.kind][1]))
        kind, cause = attempt.experiment.kind, attempt.effects[0].name
        for group in ("all", kind, "%s/%s" % (kind, cause)):
            chances[group].append(chance)
            if named:
                hits[group].append(named[number])
    for group in sorted(chances, key=lambda name: (name != "all", name)):
        told = "  named %5.1f %%" % (100.0 * numpy.mean(hits[group])) if hits[group] else ""
        print("%-52s %4d  attainable %5.1f %%%s" % (group, len(chances[group]), 100.0 * numpy.mean(chances[group]), told))


if __name__ == "__main__":
    main()
