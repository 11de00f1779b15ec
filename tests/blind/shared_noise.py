#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Healthy machines whose accelerometers share noise, and machines with one effect beside such noise: how often the program
names what is not there, and what is there. The forward model is that of `vibration.py`; the noise is drawn here."""
import argparse
import concurrent.futures
import json
import math
import os
import pathlib
import sys
import tempfile

import numpy

from draw import Request, draw_attempt
from effect import recursion
from program import run_program
from write_record import record_text

COLOURS = ("white", "coloured", "mixed")  # mixed: what is shared has another colour than what each sensor has alone
CORRELATIONS = (0.0, 0.3, 0.5, 0.7, 0.9)


def coloured(rng, count, keep):
    """AR(1) noise of unit variance."""
    lead = 200
    push = math.sqrt(1.0 - keep * keep) * rng.standard_normal(count + lead)
    return recursion(push, keep)[lead:] if keep > 0.0 else push[lead:]


def shared_noise(rng, channels, samples, correlation, colour):
    """Unit noise in each channel, with the same correlation between any two of them (of either sign)."""
    own_keep = 0.0 if colour != "coloured" else rng.uniform(0.3, 0.8)
    shared_keep = own_keep if colour != "mixed" else rng.uniform(0.3, 0.8)
    shared = coloured(rng, samples, shared_keep)
    signs = rng.choice([-1.0, 1.0], channels)
    rows = [math.sqrt(correlation) * sign * shared + math.sqrt(1.0 - correlation) * coloured(rng, samples, own_keep)
            for sign in signs]
    return numpy.stack(rows)


def draw(seed, number, correlation, colour, cause=None):
    """(text of the record, name of the hidden cause or None)"""
    request = Request(kind="vibration", situation="one" if cause else "null", cause=cause, clear=True)
    attempt, _, _ = draw_attempt(seed, number, request)
    attempt.nuisances = []
    attempt.quantum = None
    experiment = attempt.experiment
    attempt.keep[:] = True
    rng = numpy.random.default_rng([seed, number, 99])
    response = experiment.respond(list(zip(attempt.effects, attempt.scales)))
    response = response + experiment.noise_sd * shared_noise(rng, *response.shape, correlation, colour)
    metadata, columns = experiment.record(response, attempt.keep, rng, None)
    return record_text(metadata, columns)


def judged(command, text, timeout_s):
    """(names found, or what the program said instead; seconds of CPU)"""
    with tempfile.TemporaryDirectory() as folder:
        record = pathlib.Path(folder) / "record.csv"
        record.write_text(text, encoding="utf-8")
        answer = run_program([command, "diagnose", str(record), "--json"], timeout_s)
    if answer.exit_code != 0:
        return ["exit %d: %s" % (answer.exit_code, answer.errors.strip()[-200:])], answer.cpu_s
    found = json.loads(answer.output)
    return [cause["name"] for cause in found["causes"]], answer.cpu_s


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", required=True)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cases", type=int, default=20)
    parser.add_argument("--cause", help="hide this one in each record; by default nothing")
    parser.add_argument("--correlation", type=float, help="by default each of %s in turn" % (CORRELATIONS,))
    parser.add_argument("--most-false", type=float, help="share of records with a wrong name that is accepted")
    parser.add_argument("--least-right", type=float, help="share of records whose cause has to be named")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--timeout", type=float, default=600.0, help="seconds for each record")
    options = parser.parse_args()

    def one(number):
        correlation = options.correlation
        if correlation is None:
            correlation = CORRELATIONS[number % len(CORRELATIONS)]
        colour = COLOURS[number // len(CORRELATIONS) % len(COLOURS)]
        text = draw(options.seed, number, correlation, colour, options.cause)
        names, cpu_s = judged(options.program, text, options.timeout)
        return number, correlation, colour, names, cpu_s

    wrong = right = 0
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for number, correlation, colour, names, cpu_s in pool.map(one, range(options.cases)):
            wrong += any(name != options.cause for name in names)
            right += options.cause in names
            print("case %3d  correlation %.1f  %-8s  %5.1f s  %s" % (number, correlation, colour, cpu_s, ", ".join(names) or "-"),
                  flush=True)
    print("seed %d: %d of %d with a wrong name, %d with the right one" % (options.seed, wrong, options.cases, right))
    failed = options.most_false is not None and wrong > options.most_false * options.cases
    failed = failed or (options.least_right is not None and right < options.least_right * options.cases)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
