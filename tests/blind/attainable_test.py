#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The estimate of what can be named at all, where the answer is plain."""
import math
import unittest

import numpy

import draw
from attainable import probability, probability_of_name, strongest_line
from effect import nats_of_driven_mode


class Attainable(unittest.TestCase):
    def test_half_of_what_is_just_asked_for(self):
        self.assertAlmostEqual(probability(18.0, 18.0), 0.5)
        self.assertGreater(probability(32.0, 8.0), 0.999)
        self.assertEqual(probability(0.0, 8.0), 0.0)

    def test_a_line_is_its_own_strongest_line(self):
        angle = numpy.linspace(0.0, 200.0, 4000)
        signal = numpy.stack([0.2 * numpy.sin(7.3 * angle), 0.1 * numpy.cos(7.3 * angle)])
        self.assertAlmostEqual(strongest_line(signal, angle), 0.5 * (signal ** 2).sum(), delta=0.02 * (signal ** 2).sum())

    def test_what_noise_drives_says_less_than_the_same_power_that_is_known(self):
        rng = numpy.random.default_rng(1)
        response, rate_hz = numpy.zeros(8192), 1000.0
        radius, turn = math.exp(-0.02 * 2.0 * math.pi * 0.1), 2.0 * math.pi * 0.1
        for k in range(2, len(response)):
            response[k] = 2.0 * radius * math.cos(turn) * response[k - 1] - radius ** 2 * response[k - 2] + rng.standard_normal()
        response *= 10.0 / numpy.linalg.norm(response)
        nats = nats_of_driven_mode(response, rate_hz, 100.0, 0.02)
        self.assertLess(nats, 0.5 * 50.0)
        self.assertGreater(nats, 1.0)
        self.assertGreater(nats_of_driven_mode(10.0 * response, rate_hz, 100.0, 0.02), 20.0 * nats)

    def test_bearings_of_little_more_than_a_line_are_not_asked_for(self):
        request = draw.Request("vibration", "bearing_defect", "one", True)
        chances = {}
        for number in (12, 25, 37):  # shares of the strongest line: 0.58, 0.88, 0.97
            attempt, _, _ = draw.draw_attempt(5001, number, request)
            chances[number] = probability_of_name(attempt, 5)
        self.assertGreater(chances[12], 0.999)  # 42.9 sigma
        self.assertLess(chances[25], 0.1)  # 6.7 sigma
        self.assertLess(chances[37], 0.2)  # 12.9 sigma


if __name__ == "__main__":
    unittest.main()
