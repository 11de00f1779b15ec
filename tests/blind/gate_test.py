#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The gates of a set: what they count, and that they fail on the first case too many."""
import unittest

import report


def result(case, kind, status, excess=()):
    return {"case": case, "kind": kind, "situation": "one", "true": ["creep"], "sigma": [9.0], "nuisances": [], "samples": 100,
            "status": status, "named": [], "excess": list(excess), "verdict": "no_effect", "outside": None, "parameters": [],
            "heldout_ratio": None, "nearest_rival": None, "wall_s": 1.0, "cpu_s": 1.0, "peak_rss_MB": 1.0}


ARGUMENTS = dict.fromkeys(("seed", "cases", "only", "kind", "cause", "mode", "clear", "program", "out"))
SUMMARY = report.summarise([result(0, "hysteresis", "right"), result(1, "hysteresis", "right"), result(2, "motion", "missed"),
                            result(3, "motion", "error"), result(4, "motion", "false_alarm", ["backlash"])], ARGUMENTS)


class Gates(unittest.TestCase):
    def test_are_passed_by_as_many_as_they_ask_for(self):
        self.assertEqual(report.missed_gates(SUMMARY, 2, 1), [])
        self.assertEqual(report.missed_gates(SUMMARY, None, None), [])

    def test_name_each_that_is_missed(self):
        self.assertEqual(report.missed_gates(SUMMARY, 3, 0), ["2 of 5 cases are right (expected at least 3)",
                                                              "1 cases have a name that is not in them (expected at most 0)"])


if __name__ == "__main__":
    unittest.main()
