// SPDX-License-Identifier: Apache-2.0
#include "analysis/joint_dynamics/savitzky_golay.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/analysis/message_of.h"

namespace strainwave::analysis::joint_dynamics::savitzky_golay_test {
namespace {

TEST(SavitzkyGolay, HasThePublishedWeights) {
  // Savitzky and Golay (1964), table I: quadratic and cubic, 5 and 9 points; table IV: first derivative,
  // cubic, 5.
  const SavitzkyGolay five = MakeSavitzkyGolay(5, 3);
  const double smoothing[] = {-3, 12, 17, 12, -3};
  const double slope[] = {1, -8, 0, 8, -1};
  for (Eigen::Index k = 0; k < 5; ++k) {
    EXPECT_NEAR(five.smoothing(2, k), smoothing[k] / 35.0, 1e-14);
    EXPECT_NEAR(five.slope(2, k), slope[k] / 12.0, 1e-13);
  }
  const SavitzkyGolay nine = MakeSavitzkyGolay(9, 2);
  const double nine_points[] = {-21, 14, 39, 54, 59, 54, 39, 14, -21};
  for (Eigen::Index k = 0; k < 9; ++k) EXPECT_NEAR(nine.smoothing(4, k), nine_points[k] / 231.0, 1e-14);
}

TEST(SavitzkyGolay, LeavesAPolynomialOfItsOrderAsItIsToTheVeryEnds) {
  constexpr double kStep_s = 0.01;
  std::vector<double> series, slope;
  for (int i = 0; i < 60; ++i) {
    const double t = i * kStep_s;
    series.push_back(1.0 + 2.0 * t - 7.0 * t * t + 11.0 * t * t * t);
    slope.push_back(2.0 - 14.0 * t + 33.0 * t * t);
  }
  const SavitzkyGolay filter = MakeSavitzkyGolay(21, 3);
  const std::vector<double> smoothed = Smoothed(filter, series);
  const std::vector<double> derivative = Derivative(filter, series, kStep_s);
  ASSERT_EQ(smoothed.size(), series.size());
  for (std::size_t i = 0; i < series.size(); ++i) {
    EXPECT_NEAR(smoothed[i], series[i], 1e-12) << i;
    EXPECT_NEAR(derivative[i], slope[i], 1e-9) << i;
  }
}

TEST(SavitzkyGolay, IsALowPassOfTheFrequencyThatIsTold) {
  // SciPy's frequency response of the same filters at 1 kHz: −3 dB at 2.1, 10.5 and 20.9 Hz.
  EXPECT_NEAR(1000.0 * HalfPowerFrequency(MakeSavitzkyGolay(501, 3)), 2.1, 0.05);
  EXPECT_NEAR(1000.0 * HalfPowerFrequency(MakeSavitzkyGolay(101, 3)), 10.5, 0.05);
  EXPECT_NEAR(1000.0 * HalfPowerFrequency(MakeSavitzkyGolay(51, 3)), 20.9, 0.05);
  // And a sine of that frequency comes out 0.707 times as high.
  const SavitzkyGolay filter = MakeSavitzkyGolay(51, 3);
  const double frequency = HalfPowerFrequency(filter);
  std::vector<double> sine;
  for (int i = 0; i < 400; ++i) sine.push_back(std::cos(2.0 * std::numbers::pi * frequency * (i - 200)));
  EXPECT_NEAR(Smoothed(filter, sine)[200], std::sqrt(0.5), 1e-9);
}

TEST(SavitzkyGolay, RefusesEvenWindowsAndShortSeries) {
  EXPECT_EQ(MessageOf([] { MakeSavitzkyGolay(500, 3); }),
            "a window of 500 samples and the order 3 (expected an odd window above the order, and an order "
            "from 1 up)");
  EXPECT_EQ(MessageOf([] { MakeSavitzkyGolay(3, 3); }),
            "a window of 3 samples and the order 3 (expected an odd window above the order, and an order "
            "from 1 up)");
  EXPECT_EQ(MessageOf([] { Smoothed(MakeSavitzkyGolay(7, 2), std::vector<double>(6)); }),
            "a series of 6 samples for a window of 7 (expected as many or more)");
}

}  // namespace
}  // namespace strainwave::analysis::joint_dynamics::savitzky_golay_test
