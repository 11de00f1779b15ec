// SPDX-License-Identifier: Apache-2.0
// Accelerometers of one machine that share noise.
#include "analysis/diagnosis/vibration/shared_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/analysis/vibration_record.h"
#include "tests/analysis/white_noise.h"

namespace strainwave::analysis::diagnosis::diagnosis_shared_noise_test {
namespace {

using Series = std::vector<std::vector<double>>;

// Unit noise in each, a share of whose variance is the same in all.
Series Sharing(std::size_t channels, std::size_t samples, double correlation, unsigned seed) {
  const std::vector<double> shared = WhiteNoise(samples, std::sqrt(correlation), seed);
  Series series;
  for (std::size_t c = 0; c < channels; ++c) {
    series.push_back(
        WhiteNoise(samples, std::sqrt(1.0 - correlation), seed + 100 + static_cast<unsigned>(c)));
    for (std::size_t i = 0; i < samples; ++i) series.back()[i] += shared[i];
  }
  return series;
}

TEST(DecorrelationOf, IsARootOfTheInverseOfTheChannelsCorrelation) {
  constexpr double kCorrelation = 0.6;
  const Eigen::MatrixXd root = DecorrelationOf(Sharing(3, 20000, kCorrelation, 1));
  Eigen::MatrixXd expected = Eigen::MatrixXd::Constant(3, 3, kCorrelation);
  expected.diagonal().setOnes();
  constexpr double kOfMedians = 0.04;  // four standard errors of a correlation from so many samples
  EXPECT_LT(((root.transpose() * root).inverse() - expected).cwiseAbs().maxCoeff(), kOfMedians);
}

TEST(DecorrelationOf, PassesOverLinesThatAreObservableInAllChannels) {
  Series series = Sharing(2, 20000, 0.0, 2);
  for (std::vector<double>& channel : series) {
    for (std::size_t i = 0; i < channel.size(); ++i)
      channel[i] += 5.0 * std::cos(0.3 * static_cast<double>(i));
  }
  constexpr double kOfMedians = 0.04;
  const Eigen::MatrixXd root = DecorrelationOf(series);
  EXPECT_LT(((root.transpose() * root).inverse() - Eigen::MatrixXd::Identity(2, 2)).cwiseAbs().maxCoeff(),
            kOfMedians);
}

// What all sensors share is autoregressive, what each has alone is white: no one spectrum fits
// both.
TEST(SharedNoise, AccusesNoHealthyMachineWhoseSharedNoiseHasAColourOfItsOwn) {
  const Turning run(1500.0, 2.0, 0.0);
  for (const unsigned seed : {41U, 42U, 43U, 44U, 45U, 46U}) {
    VibrationData record = Record(run, seed, Silence, {1.0, 1.0, 1.0});
    const Signal shared = ColouredNoise(run, seed + 50, 3.0 * kNoise_m_per_s2, 0.75);
    for (VibrationChannel& channel : record.channels) channel.values = std::move(channel.values) + shared;
    EXPECT_EQ(Ask({record}).names(), Names{}) << seed;
  }
}

// Three sensors on a healthy machine, half of whose noise is one and the same.
TEST(SharedNoise, AccusesNoHealthyMachine) {
  const Turning run(1500.0, 2.0, 0.0);
  for (const unsigned seed : {31U, 32U, 33U}) {
    VibrationData record = Record(run, seed, Silence, {1.0, 1.0, 1.0});
    const Signal shared = ColouredNoise(run, seed + 50, kNoise_m_per_s2, 0.0);
    for (VibrationChannel& channel : record.channels) channel.values = std::move(channel.values) + shared;
    EXPECT_EQ(Ask({record}).names(), Names{}) << seed;
  }
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_shared_noise_test
