#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The scorer against answers whose mark is plain."""
import json
import unittest

from parameters import coverage, to_truth_unit
from score import judge, signature_is_right

TRUTH = {"case": 1, "kind": "transmission_error", "situation": "one", "nuisances": [], "samples": 360,
         "noise_sd": 0.02, "unit": "arcmin",
         "causes": [{"name": "backlash", "sigma": 9.0, "parameters": {"width": {"value": 0.1, "unit": "arcmin"}}}]}


def answer(verdict, *causes, **more):
    found = [{"name": name, "parameters": {}, "indistinguishable_from": list(rivals)} for name, rivals in causes]
    return json.dumps(dict({"verdict": verdict, "causes": found}, **more))


def status(truth, *words, **more):
    return judge(truth, 0, answer(*words, **more))["status"]


class Judge(unittest.TestCase):
    def test_one_effect(self):
        self.assertEqual(status(TRUTH, "effect_found", ("backlash", [])), "right")
        self.assertEqual(status(TRUTH, "effect_found", ("backlash", ["thermal_drift"])), "right")
        self.assertEqual(status(TRUTH, "effect_found", ("thermal_drift", ["backlash"])), "indistinguishable")
        self.assertEqual(status(TRUTH, "effect_found", ("thermal_drift", [])), "wrong")
        self.assertEqual(status(TRUTH, "effect_found", ("backlash", []), ("thermal_drift", [])), "false_alarm")
        self.assertEqual(status(TRUTH, "no_effect"), "missed")

    def test_broken_answers_are_errors(self):
        self.assertEqual(judge(TRUTH, 1, answer("no_effect"))["status"], "error")
        for text in ("", "{", '{"verdict": "perhaps", "causes": []}', '{"verdict": "no_effect"}', "[]"):
            self.assertEqual(judge(TRUTH, 0, text)["status"], "error", text)

    def test_nothing_and_two_and_outside(self):
        null = dict(TRUTH, situation="null", causes=[])
        self.assertEqual(status(null, "no_effect"), "right")
        self.assertEqual(status(null, "unnamed_structure"), "false_alarm")
        two = dict(TRUTH, situation="two", causes=TRUTH["causes"] + [dict(TRUTH["causes"][0], name="load_windup")])
        self.assertEqual(status(two, "effect_found", ("load_windup", []), ("backlash", [])), "both")
        self.assertEqual(status(two, "effect_found", ("load_windup", [])), "one")
        self.assertEqual(status(two, "effect_found", ("thermal_drift", [])), "none")
        outside = dict(TRUTH, situation="outside", causes=[], outside={"name": "x", "sigma": 9.0, "signature": {
            "what": "order", "regressor": "output_angle", "values": [5.0], "tolerance": 0.15}})
        found = judge(outside, 0, answer("unnamed_structure", unexplained={"signature": "order 5.02 per output revolution"}))
        self.assertEqual((found["status"], found["signature_right"]), ("right", True))
        self.assertEqual(status(outside, "effect_found", ("backlash", [])), "wrong")

    def test_heldout_error_is_compared_with_the_noise_in_its_unit(self):
        text = answer("no_effect", extended={"heldout_rmse": 1.2}, nominal={"unit": "arcsec"})
        self.assertAlmostEqual(judge(TRUTH, 0, text)["heldout_ratio"], 1.0)


class Signature(unittest.TestCase):
    def test_window(self):
        window = {"what": "window", "window": [100.0, 140.0], "values": [], "tolerance": 0.0}
        self.assertTrue(signature_is_right(window, "output angle 96-138 deg"))
        self.assertTrue(signature_is_right(window, '{"from": 104.0, "to": 150}'))
        self.assertFalse(signature_is_right(window, "output angle 10 to 300 deg"))

    def test_order_with_a_relative_room(self):
        order = {"what": "order", "values": [7.3], "tolerance": 0.02, "relative": True}
        self.assertTrue(signature_is_right(order, "a line at order 7.31"))
        self.assertFalse(signature_is_right(order, "a line at order 7.0"))


class Parameters(unittest.TestCase):
    def test_units(self):
        self.assertAlmostEqual(to_truth_unit(0.5, "deg", "arcmin"), 30.0)
        self.assertAlmostEqual(to_truth_unit(60.0, "arcsec/Nm", "arcmin/Nm"), 1.0)
        self.assertAlmostEqual(to_truth_unit(2.0, "ms", "s"), 0.002)
        self.assertIsNone(to_truth_unit(1.0, "Nm", "arcmin"))

    def test_inside_and_outside_of_the_interval(self):
        cause = TRUTH["causes"][0]
        for value, inside in ((0.11, True), (0.13, False)):
            found = coverage(cause, {"backlash_width": {"value": value, "se": 0.01, "unit": "arcmin"},
                                     "phase": {"value": 1.0, "se": 0.1, "unit": "rad"}})
            self.assertEqual([(entry["parameter"], entry["inside"]) for entry in found], [("width", inside)])


if __name__ == "__main__":
    unittest.main()
