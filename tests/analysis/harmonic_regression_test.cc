// SPDX-License-Identifier: Apache-2.0
#include "analysis/harmonic_regression.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <random>

#include "analysis/units.h"
#include "tests/analysis/chance.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::harmonic_regression_test {
namespace {

std::vector<double> UnevenAngles(std::size_t n) {
  std::mt19937 engine(11);
  std::uniform_real_distribution<double> jitter(-0.4, 0.4);
  std::vector<double> angle_rad;
  for (std::size_t i = 0; i < n; ++i) {
    angle_rad.push_back(kTwoPi * (static_cast<double>(i) + jitter(engine)) / static_cast<double>(n));
  }
  return angle_rad;
}

TEST(FitHarmonics, RecoversAmplitudesAndPhasesAtRealOrdersOverUnevenAngles) {
  const std::vector<double> angle_rad = UnevenAngles(300);
  std::vector<double> values;
  for (double angle : angle_rad) {
    // As a sum of phasors, by another route than the fit's cosine and sine.
    const std::complex<double> sum = 2.0 * std::exp(std::complex<double>(0.0, 80.0 * angle - 0.7)) +
                                     0.5 * std::exp(std::complex<double>(0.0, 81.4 * angle + 2.5));
    values.push_back(3.0 + sum.real());
  }
  const HarmonicFit fit = FitHarmonics(angle_rad, values, std::array{80.0, 81.4});
  EXPECT_NEAR(fit.constant.value, 3.0, 1e-10);
  EXPECT_NEAR(fit.harmonics[0].amplitude.value, 2.0, 1e-10);
  EXPECT_NEAR(fit.harmonics[0].phase_rad.value, 0.7, 1e-10);
  EXPECT_NEAR(fit.harmonics[1].amplitude.value, 0.5, 1e-10);
  EXPECT_NEAR(fit.harmonics[1].phase_rad.value, -2.5, 1e-10);
  EXPECT_LT(fit.residual_standard_deviation, 1e-10);
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_NEAR(HarmonicValue(fit, angle_rad[i]), values[i], 1e-10);
  }
}

TEST(FitHarmonics, ItsErrorsCoverTheTruth) {
  const std::vector<double> angle_rad = UnevenAngles(360);
  constexpr int kTrials = 400;
  int amplitude_held = 0;
  int phase_held = 0;
  for (std::uint32_t seed = 1; seed <= kTrials; ++seed) {
    std::mt19937 engine(seed);
    std::normal_distribution<double> normal(0.0, 0.3);
    std::vector<double> values;
    double noise = 0.0;
    for (double angle : angle_rad) {
      noise = 0.5 * noise + normal(engine);
      values.push_back(std::cos(2.0 * angle - 1.0) + noise);
    }
    const Harmonic harmonic = FitHarmonics(angle_rad, values, std::array{2.0}).harmonics[0];
    amplitude_held +=
        std::abs(harmonic.amplitude.value - 1.0) < 1.96 * harmonic.amplitude.standard_error ? 1 : 0;
    phase_held += std::abs(harmonic.phase_rad.value - 1.0) < 1.96 * harmonic.phase_rad.standard_error ? 1 : 0;
  }
  ExpectCoverageOf95(amplitude_held, kTrials);
  ExpectCoverageOf95(phase_held, kTrials);
}

TEST(FitHarmonics, RefusesBadArguments) {
  const std::vector<double> three = {0, 1, 2};
  EXPECT_EQ(MessageOf([&] { FitHarmonics(three, three, std::array{1.0}); }),
            "values has 3 values (expected at least 4)");
  EXPECT_EQ(MessageOf([&] { FitHarmonics(three, three, std::array{-1.0}); }),
            "order = -1 is not a positive number");
}

TEST(FoldedOrder, IsWhereSamplesShowALine) {
  EXPECT_DOUBLE_EQ(FoldedOrder(320.0, 360.0), 40.0);
  EXPECT_DOUBLE_EQ(FoldedOrder(160.0, 360.0), 160.0);
  EXPECT_DOUBLE_EQ(FoldedOrder(324.0, 360.0), 36.0);
  EXPECT_DOUBLE_EQ(FoldedOrder(360.0, 360.0), 0.0);
  // The same by the samples themselves.
  for (int i = 0; i < 360; ++i) {
    EXPECT_NEAR(std::cos(320.0 * RadFromDeg(i)), std::cos(40.0 * RadFromDeg(i)), 1e-9);
  }
}

TEST(IntegerOrderSpectrum, ShowsEachLineAtItsOrderUpToNyquist) {
  std::vector<double> angle_rad;
  std::vector<double> values;
  for (int i = 0; i < 360; ++i) {
    angle_rad.push_back(RadFromDeg(i));
    values.push_back(0.25 + std::cos(7.0 * angle_rad.back()) + 0.1 * std::sin(179.0 * angle_rad.back()));
  }
  const std::vector<double> spectrum = IntegerOrderSpectrum(angle_rad, values);
  ASSERT_EQ(spectrum.size(), 180U);
  for (std::size_t order = 0; order < spectrum.size(); ++order) {
    const double expected = order == 0 ? 0.25 : order == 7 ? 1.0 : order == 179 ? 0.1 : 0.0;
    EXPECT_NEAR(spectrum[order], expected, 1e-10) << order;
  }
}

}  // namespace
}  // namespace strainwave::analysis::harmonic_regression_test
