#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The generator by itself: the same seed gives the same bytes, records obey the contract, sizes are what was asked for."""
import math
import unittest

import numpy

import draw
from draw import Request, draw_case
from effect import Ruler, recursion
from write_record import record_text

# docs/contract.md#record-files: kind -> (columns that must be there, columns that may be there, metadata).
CONTRACT = {
    "transmission_error": ({"direction", "input_angle_deg", "output_angle_deg"},
                           {"time_s", "torque_Nm", "temperature_degC"}, {"ratio"}),
    "hysteresis": ({"time_s", "torque_Nm", "output_angle_deg"}, {"temperature_degC"}, {"t1_Nm", "t2_Nm", "t3_Nm"}),
    "motion": ({"time_s"}, {"position_rad", "torque_Nm", "velocity_rad_per_s", "position_m", "force_N",
                            "velocity_m_per_s", "temperature_degC"}, {"inertia_kgm2", "mass_kg"}),
    "vibration": (set(), {"time_s", "accel_x_m_per_s2", "accel_y_m_per_s2", "accel_z_m_per_s2",
                          "accel_motor_z_m_per_s2", "input_speed_rpm"}, {"sample_rate_hz", "input_speed_rpm"})}


def some_cases(count, **wishes):
    return [draw_case(1234, number, Request(**wishes)) for number in range(count)]


class Generator(unittest.TestCase):
    def test_the_same_seed_gives_the_same_bytes(self):
        for kind in CONTRACT:
            first, second = (draw_case(7, 3, Request(kind=kind)) for _ in range(2))
            self.assertEqual(record_text(first.metadata, first.columns), record_text(second.metadata, second.columns))
            self.assertEqual(first.truth, second.truth)
            other = draw_case(7, 4, Request(kind=kind))
            self.assertNotEqual(record_text(first.metadata, first.columns), record_text(other.metadata, other.columns))

    def test_the_largest_size_changes_sizes_alone(self):
        for kind in CONTRACT:
            drawn = [draw_case(7, 3, Request(kind=kind, situation="one", most_sigma=most)) for most in (60.0, 400.0)]
            first, second = (case.truth["wanted_sigma"][0] for case in drawn)
            self.assertAlmostEqual(math.log(second / 3.0) / math.log(400.0 / 3.0),
                                   math.log(first / 3.0) / math.log(60.0 / 3.0), places=6)
            self.assertEqual(*(case.truth["causes"][0]["name"] for case in drawn))

    def test_no_record_is_longer_than_asked_for_and_its_cause_and_size_stay(self):
        for kind, most in (("hysteresis", 2000), ("motion", 3000), ("vibration", 8000)):
            free, short = (some_cases(4, kind=kind, situation="one", most_samples=limit) for limit in (None, most))
            self.assertGreater(max(case.truth["samples"] for case in free), most, kind)
            self.assertLessEqual(max(case.truth["samples"] for case in short), most, kind)
            for first, second in zip(free, short, strict=True):
                self.assertEqual(*(case.truth["causes"][0]["name"] for case in (first, second)))
                self.assertEqual(*(case.truth["wanted_sigma"] for case in (first, second)))

    def test_records_obey_the_contract_and_their_metadata_tell_nothing_else(self):
        for kind, (needed, optional, metadata) in CONTRACT.items():
            for case in some_cases(4, kind=kind):
                self.assertLessEqual(set(case.metadata), metadata | {"kind"})
                self.assertEqual(case.metadata["kind"], kind)
                self.assertLessEqual(needed, set(case.columns))
                self.assertLessEqual(set(case.columns), needed | optional)
                lengths = {len(column if isinstance(column, list) else column[0]) for column in case.columns.values()}
                self.assertEqual(lengths, {case.truth["samples"]})
                for name, column in case.columns.items():
                    if name == "direction":
                        self.assertLessEqual(set(column), {"cw", "ccw"})
                    else:
                        self.assertTrue(numpy.all(numpy.isfinite(column[0])), name)

    def test_time_runs_forward_and_angles_start_at_zero(self):
        for kind in CONTRACT:
            for case in some_cases(4, kind=kind):
                if "time_s" in case.columns:
                    self.assertGreater(float(numpy.min(numpy.diff(case.columns["time_s"][0]))), 0.0)
                for name in ("input_angle_deg", "output_angle_deg"):
                    if name in case.columns:
                        self.assertAlmostEqual(float(case.columns[name][0][0]), 0.0)

    def test_every_cause_can_be_drawn_at_the_size_that_was_asked_for(self):
        for kind, (_, causes, _) in draw.EXPERIMENTS.items():
            for cause in causes:
                truth = draw_case(99, 1, Request(kind=kind, cause=cause, situation="one")).truth
                self.assertEqual([found["name"] for found in truth["causes"]], [cause])
                self.assertLess(abs(truth["causes"][0]["sigma"] / truth["wanted_sigma"][0] - 1.0), 0.02, cause)

    def test_what_is_chance_counts_for_nothing_in_a_size(self):
        for cause, most in (("bearing_defect", 0.99), ("torsional_resonance", 0.8)):
            found = draw_case(6, 1, Request(kind="vibration", cause=cause, situation="one")).truth["causes"][0]
            self.assertLess(found["sigma"], most * found["energy_sigma"], cause)

    def test_situations_hold_what_they_say(self):
        for kind in CONTRACT:
            for situation, count in (("null", 0), ("wrong_number", 0), ("outside", 0), ("two", 2)):
                truth = draw_case(5, 2, Request(kind=kind, situation=situation)).truth
                self.assertEqual(len(truth["causes"]), count)
                self.assertEqual("outside" in truth, situation == "outside")

    def test_clear_means_five_sigma_and_up(self):
        for case in some_cases(5, kind="transmission_error", situation="one", clear=True):
            self.assertGreater(case.truth["causes"][0]["sigma"], 4.97)


class Size(unittest.TestCase):
    def test_of_a_sine_in_white_noise_is_amplitude_times_root_half_n(self):
        angle = 2.0 * math.pi * numpy.arange(1000) / 50.0
        ruler = Ruler(numpy.ones((1000, 1)), 0.1, 0.0)
        self.assertAlmostEqual(ruler.sigma(0.02 * numpy.sin(angle)[numpy.newaxis]), 0.02 / 0.1 * math.sqrt(500.0), places=6)

    def test_of_what_the_nominal_model_mimics_is_nothing(self):
        angle = numpy.linspace(0.0, 20.0, 500)
        ruler = Ruler(numpy.stack([numpy.cos(angle), numpy.sin(angle)], axis=1), 0.1, 0.5)
        self.assertAlmostEqual(ruler.sigma(numpy.sin(angle + 0.7)[numpy.newaxis]), 0.0, places=9)

    def test_rests_on_a_recursion_that_is_the_plain_loop(self):
        push, plain = numpy.random.default_rng(1).standard_normal(300), []
        for value in push:
            plain.append(0.97 * plain[-1] + value if plain else value)
        self.assertTrue(numpy.allclose(recursion(push, 0.97), plain, rtol=0.0, atol=1e-12))

    def test_slow_signals_shrink_in_autoregressive_noise(self):
        # At frequency zero AR(1) noise of variance 1 has the density (1 + rho) / (1 - rho).
        step = (numpy.arange(4000) >= 2000).astype(float)[numpy.newaxis]
        white, coloured = (Ruler(numpy.ones((4000, 1)), 1.0, rho).sigma(step) for rho in (0.0, 0.6))
        self.assertAlmostEqual(coloured / white, math.sqrt(0.4 / 1.6), delta=0.01)


if __name__ == "__main__":
    unittest.main()
