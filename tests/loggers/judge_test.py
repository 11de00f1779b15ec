#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The judge against answers whose worth is plain, and the generator against its own promises."""
import json
import unittest

import numpy

import draw_record
import machines
from judge import judge, warnings_of
from record import Record, Truth

LOOP = Record("hysteresis", {}, {}, {}, {}, {"k1_Nm_per_rad": Truth(16000.0, 0.01, 0.0)}, {})
GEAR = Record("transmission_error", {}, {}, {}, {}, {"second_harmonic_amplitude_arcmin": Truth(0.5, 0.0, 0.01)},
              {"backlash": {"backlash_arcmin": Truth(0.2, 0.0, 0.01)}})


def recomputed(k1, se=10.0, warnings=(), checks=()):
    return json.dumps({"kind": "hysteresis", "k1_Nm_per_rad": k1, "k1_Nm_per_rad_se": se, "warnings": list(warnings),
                       "failed_checks": list(checks)})


def diagnosed(verdict, *causes, second=0.5):
    parameters = {"second_harmonic_amplitude_arcmin": {"value": second, "se": 0.001}}
    found = [{"name": name, "indistinguishable_from": list(rivals), "parameters": {"backlash_arcmin": {"value": size, "se": 0.001}}}
             for name, rivals, size in causes]
    return json.dumps({"verdict": verdict, "causes": found, "nominal": {"parameters": parameters}, "warnings": []})


class Judge(unittest.TestCase):
    def status(self, *answer, record=LOOP):
        return judge(record, *answer).status

    def test_a_number_is_right_within_four_stated_errors_and_a_share(self):
        self.assertEqual(self.status(0, recomputed(16190.0), ""), "right")
        self.assertEqual(self.status(0, recomputed(16210.0), ""), "silent")
        self.assertEqual(self.status(0, recomputed(17900.0, se=500.0), ""), "right")
        self.assertEqual(self.status(0, recomputed(float("nan")), ""), "silent")

    def test_a_wrong_number_with_a_word_is_not_silent(self):
        self.assertEqual(self.status(0, recomputed(8000.0, warnings=["t1_Nm: 7 was taken"]), ""), "warned")
        self.assertEqual(self.status(0, recomputed(8000.0), "r.csv: warning: torque_Nm repeats 12 rows"), "warned")
        self.assertEqual(self.status(0, recomputed(8000.0), "12 of 30, 3 s to go"), "silent")
        self.assertEqual(self.status(0, recomputed(8000.0, warnings=["no verdict on creep: there are no holds"]), ""), "silent")
        self.assertEqual(self.status(1, recomputed(8000.0, checks=["the residual is 15 times the noise"]), ""), "refused")
        self.assertEqual(self.status(2, "", "r.csv:3:1: error: t1 is not known (expected t1_Nm)"), "refused")

    def test_no_answer_in_words_is_broken(self):
        for code, output, errors in ((2, "", ""), (1, recomputed(16000.0), ""), (-11, "", ""), (3, "", "error"), (0, "{", "")):
            self.assertEqual(self.status(code, output, errors), "broken")

    def test_a_number_that_is_not_given_is_missing_and_not_wrong(self):
        verdict = judge(LOOP, 0, recomputed(None), "")
        self.assertEqual((verdict.status, verdict.missing), ("right", ["k1_Nm_per_rad"]))

    def test_accusations(self):
        self.assertEqual(self.status(0, diagnosed("no_effect"), "", record=GEAR), "right")
        self.assertEqual(self.status(0, diagnosed("effect_found", ("backlash", (), 0.2)), "", record=GEAR), "right")
        self.assertEqual(self.status(0, diagnosed("effect_found", ("backlash", (), 0.5)), "", record=GEAR), "silent")
        self.assertEqual(self.status(0, diagnosed("effect_found", ("thermal_drift", (), 0.2)), "", record=GEAR), "silent")
        self.assertEqual(self.status(0, diagnosed("effect_found", ("thermal_drift", ("backlash",), 9.0)), "", record=GEAR), "right")
        self.assertEqual(self.status(0, diagnosed("unnamed_structure"), "", record=GEAR), "silent")
        self.assertEqual(self.status(0, diagnosed("no_effect", second=0.6), "", record=GEAR), "silent")

    def test_what_was_not_looked_at_is_no_warning(self):
        answer = {"warnings": ["no verdict on creep: there are no holds", "imbalance cannot be judged: one speed", "t1_Nm: 7 was taken"]}
        self.assertEqual(warnings_of(answer, "r.csv: warning: imbalance cannot be judged: one speed\n12 of 30, 3 s to go"),
                         ["t1_Nm: 7 was taken"])
        self.assertEqual(warnings_of({}, "r.csv: warning: torque_Nm repeats 12 rows"), ["torque_Nm repeats 12 rows"])


class Draw(unittest.TestCase):
    def test_the_same_seed_and_number_give_the_same_record(self):
        for number in range(12):
            first, second = draw_record.draw(5, number), draw_record.draw(5, number)
            self.assertEqual((first.done, first.record.text()), (second.done, second.record.text()))
            self.assertGreater(len(first.done), 0)

    def test_nothing_is_done_to_a_clean_record(self):
        self.assertEqual(draw_record.draw(5, draw_record.CLEAN).done, [])

    def test_everything_has_its_turn(self):
        words = " ".join("; ".join(draw_record.draw(5, number).done) for number in range(400))
        for said in ("wrapped", "held", "frozen", "stands still", "in steps", "outliers", "a gap", "decimals", "off by up to", "times",
                     "other sign", "another order", " as ", "without", " for ", "# ",
                     "share noise", "is slow", "swapped", "ends at", "written twice"):
            self.assertIn(said, words)


class Machines(unittest.TestCase):
    def test_a_torsion_loop_has_the_slopes_of_its_gear(self):
        record = machines.torsion_loop(numpy.random.default_rng(3))
        torque, twist = record.columns["torque_Nm"], numpy.radians(record.columns["output_angle_deg"])
        loading = slice(0, int(numpy.argmax(torque)))
        knee_Nm = float(record.metadata["t2_Nm"]) + record.truth["friction_torque_Nm"].value  # the spring's own, friction beside it
        beyond = (torque[loading] > knee_Nm).nonzero()[0]
        slope = numpy.polyfit(twist[beyond], torque[beyond], 1)[0]
        self.assertAlmostEqual(slope / record.truth["k3_Nm_per_rad"].value, 1.0, delta=1e-6)
        self.assertAlmostEqual(torque.max() / float(record.metadata["t3_Nm"]), 1.0, delta=1e-3)

    def test_a_sweep_has_the_means_and_extremes_of_its_gear(self):
        record = machines.sweep(numpy.random.default_rng(4))
        way = numpy.array(record.columns["direction"]) == "cw"
        ratio, absolute = float(record.metadata["ratio"]), "absolute" in record.metadata
        turned, out = record.columns["input_angle_deg"], record.columns["output_angle_deg"]
        error = 60.0 * (turned / ratio - out)
        error = error[way] - (0.0 if absolute else error[0])
        self.assertAlmostEqual(error[:-1].mean(), record.truth["e_avg_arcmin"].value, delta=0.01)
        self.assertAlmostEqual(numpy.ptp(error), record.truth["e_max_arcmin"].value, delta=1e-9)

    def test_a_machine_that_stands_turns_on_from_where_it_stood(self):
        record = machines.axis(numpy.random.default_rng(5))
        position, rows = record.columns["position_rad"], record.rows()
        record.stay(100, 50)
        self.assertEqual(record.rows(), rows + 50)
        self.assertEqual(set(record.columns["position_rad"][100:150]), {position[100]})
        self.assertLess(numpy.ptp(numpy.diff(record.columns["time_s"])), 1e-9)


if __name__ == "__main__":
    unittest.main()
