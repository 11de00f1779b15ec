// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/diagnosis/noise_likelihood.h"
#include "tests/analysis/white_noise.h"

namespace strainwave::analysis::diagnosis::diagnosis_noise_likelihood_test {
namespace {

const std::vector<std::size_t> kOneSegment{0};

// What is left is largest where an effect is that the model lacks, often next to a gap: that is no
// autocorrelation.
TEST(NoiseLikelihood, DoesNotTakeLargeSamplesNextToGapsForAutocorrelation) {
  std::vector<double> noise = WhiteNoise(1000, 0.1, 4);
  std::vector<double> weights(noise.size(), 1.0);
  for (std::size_t i = 0; i < noise.size(); ++i) {
    if (i % 20 == 0) weights[i] = 0.0;
    if (i % 20 == 1) noise[i] *= 6.0;
  }
  EXPECT_EQ(FitNoise(noise, weights, kOneSegment, 4, 1.0).order, 0);
}

// Between gaps that leave six samples each, autoregressive noise looks like a level: it brings no more than
// chance does where each sample is predicted by as many as there are before it.
TEST(NoiseLikelihood, KnowsTheAutocorrelationOfSamplesNextToGaps) {
  constexpr std::size_t kRuns = 100;
  constexpr std::size_t kRun = 6;
  constexpr double kLagOne = 0.8;
  constexpr unsigned kRecords = 50;
  std::vector<double> weights;
  for (std::size_t i = 0; i < kRuns * (kRun + 1); ++i) weights.push_back(i % (kRun + 1) == kRun ? 0.0 : 1.0);
  double mean_ratio = 0.0;
  for (unsigned record = 0; record < kRecords; ++record) {
    std::vector<double> noise = WhiteNoise(weights.size(), 1.0, record);
    for (std::size_t i = 1; i < noise.size(); ++i) noise[i] += kLagOne * noise[i - 1];
    // A level that goes up and down every few runs, by least squares.
    const auto level = [](std::size_t i) { return i / (kRun + 1) % 6 < 3 ? 1.0 : -1.0; };
    double along = 0.0;
    for (std::size_t i = 0; i < noise.size(); ++i) along += weights[i] * level(i) * noise[i];
    std::vector<double> left = noise;
    for (std::size_t i = 0; i < left.size(); ++i) left[i] -= along / (kRuns * kRun) * level(i);
    mean_ratio += LikelihoodRatio(FitNoise(left, weights, kOneSegment, 4, 1.0),
                                  FitNoise(noise, weights, kOneSegment, 4, 1.0)) /
                  kRecords;
  }
  EXPECT_LT(mean_ratio, 2.0);
}

// Two channels, of which one is autoregressive and larger.
TEST(NoiseLikelihood, IsOfEachSeriesWhatItIsAlone) {
  constexpr std::size_t kOne = 4000;
  std::vector<double> both = WhiteNoise(2 * kOne, 1.0, 11);
  for (std::size_t i = 1; i < kOne; ++i) both[i] += 0.7 * both[i - 1];
  for (std::size_t i = kOne; i < both.size(); ++i) both[i] *= 0.3;
  const std::vector<double> weights(both.size(), 1.0);
  const std::vector<std::size_t> starts{0, kOne};
  const NoiseFit fit = FitNoise(both, weights, starts, 1, 1.0, starts);
  ASSERT_EQ(fit.series.size(), 2U);
  EXPECT_EQ(fit.order, 1);
  EXPECT_NEAR(fit.series[0].coefficients[0], 0.7, 0.04);
  EXPECT_NEAR(fit.series[1].coefficients[0], 0.0, 0.05);
  EXPECT_NEAR(fit.series[0].innovation_sd, 1.0, 0.04);
  EXPECT_NEAR(fit.series[1].innovation_sd, 0.3, 0.012);
  const std::span<const double> all(both);
  const std::span<const double> ones(weights);
  for (std::size_t order = 0; order <= 1; ++order) {
    double alone = 0.0;
    for (const std::size_t first : starts) {
      alone +=
          FitNoise(all.subspan(first, kOne), ones.first(kOne), kOneSegment, 1, 1.0).log_likelihood[order];
    }
    EXPECT_NEAR(fit.log_likelihood[order], alone, 1e-9 * std::abs(alone));
  }
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_noise_likelihood_test
