// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/rotation_results.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bench/campaign/cycle_results.h"

namespace strainwave::bench::rotation_results_test {
namespace {

constexpr std::size_t kSamples = 25600;

std::vector<float> Noise(double step) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal(0.02, 0.2);
  std::vector<float> samples(kSamples);
  for (float& sample : samples) sample = static_cast<float>(step * std::round(normal(engine) / step));
  return samples;
}

Result RmsOf(std::vector<float> samples) {
  daq::Record record{.kind = daq::RecordKind::kVibration, .metadata = {}, .columns = {}, .source = {}};
  record.columns.push_back({"accel_x_m_per_s2", std::move(samples), {}, {}});
  return VibrationResults(record).at(0);
}

TEST(VibrationRms, IsThatAboutTheMean) {
  const Result result = RmsOf(Noise(1e-4));
  EXPECT_EQ(result.quantity, "vibration_rms_accel_x_m_per_s2");
  EXPECT_NEAR(result.value, 0.2, 0.005);
  EXPECT_EQ(result.flag, "");
}

// A bus that is cut at the end of a rotation leaves the converter at its end: no vibration of 123 m/s2.
TEST(VibrationRms, IsFlaggedWhereTheSensorDiesOnTheWay) {
  std::vector<float> samples = Noise(1e-4);
  std::fill(samples.end() - 1200, samples.end(), 653.7F);
  const Result result = RmsOf(samples);
  EXPECT_GT(result.value, 50.0);
  EXPECT_EQ(result.flag,
            "1200 of 25600 samples stand at one value: not connected, or at the end of its range");
  EXPECT_FALSE(IsSound(result));
}

TEST(VibrationRms, IsFlaggedWhereTheSensorIsNotConnected) {
  EXPECT_EQ(RmsOf(std::vector<float>(kSamples, 0.0F)).flag,
            "25600 of 25600 samples stand at one value: not connected, or at the end of its range");
}

TEST(VibrationRms, IsFlaggedWhereTheRangeEnds) {
  std::vector<float> samples = Noise(1e-4);
  std::size_t at_its_end = 0;
  // A slow swing takes it there for many samples in a row.
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i] += std::sin(0.003F * static_cast<float>(i));
    if (samples[i] >= 1.0F) ++at_its_end;
    samples[i] = std::min(samples[i], 1.0F);
  }
  EXPECT_EQ(RmsOf(samples).flag.substr(0, 5), std::to_string(at_its_end).substr(0, 4) + " ");
}

// Equal samples of a coarse converter are its resolution.
TEST(VibrationRms, OfACoarseConverterIsSound) { EXPECT_EQ(RmsOf(Noise(0.3)).flag, ""); }

}  // namespace
}  // namespace strainwave::bench::rotation_results_test
