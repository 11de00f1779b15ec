# SPDX-License-Identifier: Apache-2.0
"""How far the nearest other cause of the list is from the hidden one, in sigmas: what no analyst could tell apart.

Each rival is drawn a few times and scaled to fit; a rival with a free phase is two columns. A rival whose details nobody could
hit by chance (windows, positions, orders) is left out, so the distance is an upper bound.
"""
import numpy

DRAWS = 3
FREE_PHASE = ("wave_generator_first_harmonic", "wave_generator_fourth_harmonic", "output_eccentricity",
              "circular_spline_ovality", "gravity_load")
# Needles in a haystack, or costly to integrate for a bound that hardly changes.
LEFT_OUT = ("local_tooth_damage", "external_disturbance", "position_periodic_torque", "rate_dependence",
            "torsional_resonance")


def _possible(experiment, name):
    if experiment.kind == "transmission_error":
        two_ways = bool(numpy.ptp(experiment.sense))
        return not (name == "backlash" and not two_ways) and not (name == "load_windup" and not experiment.has_torque)
    if experiment.kind == "motion":
        return name != "backlash" and not (name == "gravity_load" and experiment.linear)
    return experiment.kind == "hysteresis"


def nearest(attempt, causes):
    """(name, sigmas that remain when the rival has taken what it can) for a single hidden effect; None without a rival."""
    rng = numpy.random.default_rng(0)
    signal, hidden = attempt.signals[0].ravel(), attempt.effects[0].name
    nominal = attempt.respond([])
    best = None
    for name in causes:
        if name == hidden or name in LEFT_OUT or not _possible(attempt.experiment, name):
            continue
        columns = []
        for _ in range(2 if name in FREE_PHASE else DRAWS):
            rival = attempt.experiment.make_effect(name, rng)
            column = attempt.ruler.residual_of(attempt.respond([(rival, rival.first_scale)]) - nominal).ravel()
            columns.append(column)
        trials = [numpy.stack(columns, axis=1)] if name in FREE_PHASE else [column[:, numpy.newaxis] for column in columns]
        for trial in trials:
            taken = trial @ numpy.linalg.lstsq(trial, signal, rcond=None)[0]
            apart = float(numpy.linalg.norm(signal - taken))
            if best is None or apart < best[1]:
                best = (name, apart)
    return best
