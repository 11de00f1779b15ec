// SPDX-License-Identifier: Apache-2.0
#include "analysis/extremes_under_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace strainwave::analysis::extremes_under_noise_test {
namespace {

// The truth by drawing.
RangeUnderNoise Draw(const std::vector<double>& curve, double sigma, int draws) {
  std::mt19937 engine(3);
  std::normal_distribution<double> normal(0.0, sigma);
  const auto [low, high] = std::minmax_element(curve.begin(), curve.end());
  const double range = *high - *low;
  double sum = 0.0;
  double square = 0.0;
  for (int draw = 0; draw < draws; ++draw) {
    std::vector<double> noisy = curve;
    for (double& value : noisy) {
      value += normal(engine);
    }
    const auto [noisy_low, noisy_high] = std::minmax_element(noisy.begin(), noisy.end());
    const double off = *noisy_high - *noisy_low - range;
    sum += off / draws;
    square += off * off / draws;
  }
  return {sum, std::sqrt(square)};
}

TEST(ExpectRangeUnderNoise, AgreesWithDrawing) {
  std::vector<double> curve;
  for (int i = 0; i < 360; ++i) {
    curve.push_back(std::cos(0.0174533 * i) + 0.3 * std::cos(0.0174533 * 7 * i));
  }
  for (const double sigma : {0.01, 0.1, 0.4}) {
    const RangeUnderNoise expected = Draw(curve, sigma, 4000);
    const RangeUnderNoise result = ExpectRangeUnderNoise(curve, sigma);
    EXPECT_NEAR(result.bias, expected.bias, 0.08 * sigma) << sigma;
    EXPECT_NEAR(result.root_mean_square_error, expected.root_mean_square_error, 0.08 * sigma) << sigma;
  }
}

TEST(ExpectRangeUnderNoise, ThinsALongCurveWithoutLosingIt) {
  const std::vector<double> flat(5000, 1.0);
  const RangeUnderNoise expected = Draw(flat, 1.0, 1000);
  EXPECT_NEAR(ExpectRangeUnderNoise(flat, 1.0).bias, expected.bias, 0.06);
}

TEST(ExpectRangeUnderNoise, IsZeroWithoutNoise) {
  EXPECT_EQ(ExpectRangeUnderNoise(std::vector<double>{1.0, 2.0}, 0.0).bias, 0.0);
}

}  // namespace
}  // namespace strainwave::analysis::extremes_under_noise_test
