#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The further generators: the same seed gives the same bytes, each cause can be drawn, axes follow their reference, sizes hold."""
import dataclasses
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

import numpy

from draw import Request
from generate_test import CONTRACT
from generators import cases, figures, registry
from generators.axis_model import AxisModel
from generators.cases import draw_case
from generators.friction import BoucWen, Dahl, LuGre, MaxwellSlip
from generators.noise import Noise, shared_mixing
from generators.size import Ruler, find_scale, incoherent_sigma, matched_sigma
from generators.torsion import Torsion, twist_under
from write_record import record_text

AXES = [generator for generator in registry.GENERATORS.values() if generator.kind == "motion"]
# What the names stand for, for good.
ROLES = {"stepped_gear": "tuning", "running_gear": "figures only", "staircase_loop": "tuning", "servo_loop": "figures only",
         "lugre_cascade_axis": "tuning", "slip_feedforward_axis": "figures only", "dahl_dither_axis": "tuning",
         "bouc_wen_observer_axis": "figures only", "modal_vibration": "tuning", "run_up_vibration": "figures only"}


def short_axes():
    """Motions of two seconds: a tenth of what a record's simulation costs."""
    return mock.patch.object(AxisModel, "seconds", (1.8, 2.2))


class Registry(unittest.TestCase):
    def test_keeps_each_role_and_half_are_for_figures_only(self):
        self.assertEqual({name: generator.role for name, generator in registry.GENERATORS.items()}, ROLES)
        self.assertEqual(len(registry.named("tuning")), len(registry.named("figures_only")))
        for kind in CONTRACT:
            self.assertEqual({g.role for g in registry.GENERATORS.values() if g.kind == kind}, {"tuning", "figures only"}, kind)

    def test_takes_names_and_roles_and_refuses_others(self):
        self.assertEqual([g.name for g in registry.named("servo_loop,stepped_gear,servo_loop")], ["servo_loop", "stepped_gear"])
        self.assertRaises(KeyError, registry.named, "servo_loop,tunning")


class Records(unittest.TestCase):
    def test_are_the_same_bytes_for_the_same_seed_and_obey_the_contract(self):
        with short_axes():
            for generator in registry.GENERATORS.values():
                first, second = (draw_case(7, 3, Request(situation="null"), generator) for _ in range(2))
                text = record_text(first.metadata, first.columns)
                self.assertEqual(text, record_text(second.metadata, second.columns), generator.name)
                self.assertEqual(first.truth, second.truth)
                other = draw_case(7, 4, Request(situation="null"), generator)
                self.assertNotEqual(text, record_text(other.metadata, other.columns))
                needed, optional, metadata = CONTRACT[generator.kind]
                self.assertLessEqual(set(first.metadata), metadata | {"kind"})
                self.assertLessEqual(needed, set(first.columns))
                self.assertLessEqual(set(first.columns), needed | optional)
                for name, column in first.columns.items():
                    self.assertEqual(len(column if name == "direction" else column[0]), first.truth["samples"])
                    self.assertTrue(name == "direction" or numpy.all(numpy.isfinite(column[0])), name)
                if "time_s" in first.columns:
                    self.assertGreater(float(numpy.min(numpy.diff(first.columns["time_s"][0]))), 0.0, generator.name)

    def test_of_two_generators_are_not_drawn_alike(self):
        generator = registry.GENERATORS["stepped_gear"]
        first, second = (draw_case(7, 3, Request(situation="null"), each) for each in (generator, dataclasses.replace(generator, name="other")))
        self.assertNotEqual(record_text(first.metadata, first.columns), record_text(second.metadata, second.columns))

    def test_tell_nothing_of_the_truth_which_is_in_another_folder(self):
        run = pathlib.Path(__file__).with_name("run")
        with tempfile.TemporaryDirectory() as out:
            done = subprocess.run([sys.executable, "-B", str(run), "--seed", "3", "--cases", "2", "--mode", "one", "--generate-only", "--out",
                                   out, "--generator", "stepped_gear,modal_vibration"], capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            for name in ("stepped_gear", "modal_vibration"):
                records = sorted(pathlib.Path(out, name, "records").iterdir())
                self.assertEqual(len(records), 2)
                for record in records:
                    truth = pathlib.Path(out, name, "truth", record.stem + ".json").read_text(encoding="utf-8")
                    self.assertIn('"sigma"', truth)
                    comments = [line for line in record.read_text(encoding="utf-8").splitlines() if line.startswith("#")]
                    self.assertLessEqual({line[2:].partition(":")[0] for line in comments}, CONTRACT[registry.GENERATORS[name].kind][2] | {"kind"})


class Effects(unittest.TestCase):
    def test_of_every_name_can_be_drawn_and_are_seen(self):
        with short_axes():
            for generator in registry.GENERATORS.values():
                model = None
                for number, cause in enumerate(generator.model.causes):
                    rng = numpy.random.default_rng([11, number])
                    if model is None or generator.kind in ("transmission_error", "vibration"):
                        model = generator.model(rng, (cause,))
                        ruler = Ruler(model.regressors(), model.noise)
                    effect = next(filter(None, (model.make_effect(cause, rng) for _ in range(20))))
                    self.assertEqual(effect.name, cause)
                    residual = model.residual([(effect, effect.first_scale)])
                    self.assertGreater(matched_sigma(ruler.residual_of(residual)), 0.1, (generator.name, cause, effect.law))

    def test_have_the_size_that_was_asked_for(self):
        for name, cause in (("stepped_gear", "backlash"), ("run_up_vibration", "gear_mesh"), ("servo_loop", "torque_zero_offset")):
            truth = draw_case(5, 1, Request(cause=cause, situation="one"), registry.GENERATORS[name]).truth
            self.assertEqual([found["name"] for found in truth["causes"]], [cause])
            self.assertLess(abs(truth["causes"][0]["sigma"] / truth["wanted_sigma"][0] - 1.0), 0.03, name)


class ClosedLoop(unittest.TestCase):
    def test_follows_its_reference_and_hides_nothing_when_clean(self):
        with short_axes():
            for generator in AXES:
                model = generator.model(numpy.random.default_rng(4), ())
                error = model.clean.position[1:] - model.reference
                self.assertLess(float(error.std()), 0.01 * model.reach, generator.name)
                left = Ruler(model.regressors(), model.noise).residual_of(model._sampled(model._clean_residual)[numpy.newaxis])
                self.assertLess(matched_sigma(left), 3.0, generator.name)

    def test_gives_back_a_hidden_torque_along_the_path_that_it_went(self):
        # The answer is known: the term itself, at the angles that the axis went through.
        with short_axes():
            for generator in AXES:
                model = generator.model(numpy.random.default_rng(6), ())
                effect = model.make_effect("gravity_load", numpy.random.default_rng(1))
                residual = model.residual([(effect, 0.05)])[0]
                run = model._run([(effect, 0.05)])
                (term,) = effect.act(0.05).terms
                known = model._sampled(numpy.array([term(0.0, angle, 0.0, 0.0, 0.0) for angle in 0.5 * (run.position[1:] + run.position[:-1])]))
                self.assertLess(float(numpy.max(numpy.abs(residual - known))), 0.02 * 0.05 * model.span, generator.name)

    def test_sticks_below_the_level_and_slides_above_it(self):
        for law in (lambda: LuGre(1e-4, 0.0), lambda: MaxwellSlip([0.4, 0.6], [5e-5, 2e-4]), lambda: Dahl(1e-4, 1.5), lambda: BoucWen(1e-4, 2.0, 0.6)):
            for push, most, least in ((0.7, 2e-3, 0.0), (1.2, 1e9, 0.05)):
                contact, position, speed, share = law(), 0.0, 0.0, 0.0
                for _ in range(4000):
                    speed += 2.5e-4 * (push - share - 0.5 * speed) / 0.05
                    position += 2.5e-4 * speed
                    share = contact.step(2.5e-4 * speed, 2.5e-4)
                self.assertLess(position, most, type(contact).__name__)
                self.assertGreater(position, least, type(contact).__name__)


class Sizes(unittest.TestCase):
    def test_of_a_sine_in_white_noise_is_amplitude_times_root_half_n(self):
        signal = 0.02 * numpy.sin(2.0 * math.pi * numpy.arange(1000) / 50.0)[numpy.newaxis]
        self.assertAlmostEqual(matched_sigma(Ruler(numpy.ones((1000, 1)), Noise(0.1)).residual_of(signal)), 0.2 * math.sqrt(500.0), places=6)

    def test_of_a_slow_signal_in_ar2_noise_is_by_the_density_at_zero(self):
        noise = Noise(1.0, 0.9, -0.2)
        step = (numpy.arange(4000) >= 2000).astype(float)[numpy.newaxis]
        white, coloured = (matched_sigma(Ruler(numpy.ones((4000, 1)), kind).residual_of(step)) for kind in (Noise(1.0), noise))
        self.assertAlmostEqual(coloured / white, (1.0 - noise.a1 - noise.a2) / noise.innovation_sd(), delta=0.01)

    def test_rest_on_noise_that_is_what_it_says(self):
        rng = numpy.random.default_rng(1)
        for noise in (Noise(0.3, 0.9, -0.3, "laplace"), Noise(0.3, tails="student", mixing=shared_mixing(rng, 3))):
            drawn = noise.draw(rng, (3, 40000))
            self.assertTrue(numpy.allclose(drawn.std(axis=1), 0.3, rtol=0.03))
            white = noise.whiten(drawn)
            self.assertTrue(numpy.allclose(white @ white.T / 40000.0, numpy.eye(3), atol=0.04))
            self.assertLess(float(numpy.max(numpy.abs((white[:, 1:] * white[:, :-1]).mean(axis=1)))), 0.02)

    def test_of_chance_is_less_than_its_energy(self):
        signal = 0.3 * numpy.random.default_rng(2).standard_normal((1, 6400))
        self.assertLess(incoherent_sigma(signal), 0.6 * matched_sigma(signal))
        # Where it is far above the noise hardly anything is lost.
        self.assertGreater(incoherent_sigma(100.0 * signal), 0.97 * matched_sigma(100.0 * signal))

    def test_are_met_by_the_scale_that_is_looked_for(self):
        self.assertAlmostEqual(find_scale(lambda scale: scale + 3.0 * scale ** 2, 0.1, 10.0, 14.0), 2.0, delta=0.02)
        self.assertIsNone(find_scale(lambda scale: scale, 0.1, 10.0, 14.0))


class LockTest(unittest.TestCase):
    def test_of_stiffness_alone_is_the_straight_pieces(self):
        torque = numpy.concatenate([numpy.linspace(0.0, 30.0, 200), numpy.linspace(30.0, -30.0, 400)])
        torsion = Torsion(1e4, 2e4, 3e4, 7.0, 25.0, (1e-9,), (1e-4,))
        size = numpy.abs(torque)
        known = numpy.sign(torque) * (numpy.minimum(size, 7.0) / 1e4 + (size.clip(7.0, 25.0) - 7.0) / 2e4 + (size - 25.0).clip(0.0) / 3e4)
        self.assertLess(float(numpy.max(numpy.abs(twist_under(torsion, numpy.arange(600.0), torque) - known))), 1e-7)

    def test_with_friction_is_a_loop_as_wide_as_two_levels(self):
        torque = numpy.concatenate([numpy.linspace(0.0, 6.0, 300), numpy.linspace(6.0, -6.0, 600), numpy.linspace(-6.0, 6.0, 600)])
        twist = twist_under(Torsion(1e4, 1e4, 1e4, 7.0, 25.0, (1.0,), (1e-5,)), numpy.arange(1500.0), torque)
        down, up = (numpy.interp(0.0, torque[part][::order], twist[part][::order]) for part, order in ((slice(300, 900), -1), (slice(900, 1500), 1)))
        self.assertAlmostEqual(down - up, 2.0 * 1.0 / 1e4, delta=2e-6)


class Figures(unittest.TestCase):
    @staticmethod
    def result(generator, case, status, situation="one", named=("creep",)):
        return {"generator": generator, "case": case, "kind": "hysteresis", "situation": situation, "true": ["creep"], "status": status,
                "sigma": [9.0] if situation == "one" else [], "named": list(named), "excess": [], "parameters": [], "verdict": "no_effect",
                "nuisances": [], "outside": None, "nearest_rival": None}

    def test_of_the_worst_generator_lead_and_single_cases_are_told_of_tuning_alone(self):
        results = [self.result("staircase_loop", 1, "right"), self.result("staircase_loop", 2, "missed"),
                   self.result("servo_loop", 31, "missed"), self.result("servo_loop", 32, "false_alarm", "null")]
        rows = figures.summarise(results)
        self.assertEqual([name for name, _ in rows], ["servo_loop", "staircase_loop"])
        self.assertEqual(rows[0][1]["clean: accused"], {"count": 1, "of": 1})
        text = figures.text(rows, results, 5)
        self.assertIn("   2 missed hysteresis", text)
        self.assertNotIn("  31 missed", text)


class Rivals(unittest.TestCase):
    def test_take_what_a_free_phase_can(self):
        model = registry.GENERATORS["stepped_gear"].model(numpy.random.default_rng(8), ())
        ruler = Ruler(model.regressors(), model.noise)
        hidden = mock.Mock()
        hidden.name = "backlash"
        signal = 0.1 * numpy.sin(model.output_rad + 1.234)[numpy.newaxis]
        name, apart = cases._nearest(model, ruler, hidden, signal)
        self.assertEqual(name, "output_eccentricity")
        self.assertLess(apart, 0.25 * matched_sigma(ruler.residual_of(signal)))


if __name__ == "__main__":
    unittest.main()
