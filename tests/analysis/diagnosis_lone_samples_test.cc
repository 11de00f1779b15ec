// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "analysis/diagnosis/lone_samples.h"
#include "tests/analysis/white_noise.h"

namespace strainwave::analysis::diagnosis::diagnosis_lone_samples_test {
namespace {

TEST(LoneSamples, StandOffBothSides) {
  std::vector<double> signal(400);
  std::mt19937 random(21);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < signal.size(); ++i) signal[i] = 0.1 * normal(random) + (i < 200 ? -5.0 : 5.0);
  EXPECT_EQ(FindLoneSamples(signal), std::vector<std::size_t>{});  // a step is none, nor its foot
  signal[60] += 1.5;
  signal[300] -= 1.5;
  signal[120] += 1.5, signal[121] += 1.5;  // two samples may be something
  EXPECT_EQ(FindLoneSamples(signal), (std::vector<std::size_t>{60, 300}));
  EXPECT_EQ(FindLoneSamples(signal, 0.8), std::vector<std::size_t>{});  // two steps of a coarse converter
}

TEST(LoneSamples, ShowInATorqueThatChangesFasterThanThey) {
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<double> signal;
  for (int i = 0; i < 400; ++i) {
    const double swing = 80.0 * std::sin(0.3 * i);                      // 24 a sample
    const double corner = i > 250 ? 20.0 * std::min(i - 250, 3) : 0.0;  // a ramp of three samples
    const double step = i < 120 ? 0.0 : i == 120 ? 10.0 : 30.0;         // a friction that turns round
    signal.push_back(swing + corner + step + noise(random));
  }
  EXPECT_EQ(FindLoneSamples(signal), std::vector<std::size_t>{});
  signal[200] += 60.0;
  signal[300] -= 60.0;
  EXPECT_EQ(FindLoneSamples(signal), (std::vector<std::size_t>{200, 300}));
}

TEST(LoneSamples, AreFoundSideBySideWhereThereAreMany) {
  std::vector<double> signal = WhiteNoise(4000, 1.0, 7);
  std::vector<std::size_t> spikes;
  for (std::size_t i = 100; i < 3900; i += 190) spikes.push_back(i);
  spikes.insert(spikes.begin() + 1, spikes[0] + 1);
  for (const std::size_t spike : spikes) signal[spike] += 10.0;
  EXPECT_EQ(FindLoneSamples(signal), spikes);
}

TEST(LoneSamples, TakeTwoSideBySideForRealWhereNoOtherStandsOff) {
  std::vector<double> signal = WhiteNoise(4000, 1.0, 7);
  signal[100] += 10.0;
  signal[101] += 10.0;
  EXPECT_EQ(FindLoneSamples(signal), std::vector<std::size_t>{});
}

// Something that rings moves more samples than two: of those no more are lone than without the spikes.
TEST(LoneSamples, LeaveResonances) {
  std::vector<double> signal = WhiteNoise(4000, 1.0, 7);
  for (std::size_t i = 0; i < 60; ++i) {
    const double since = static_cast<double>(i);
    signal[2050 + i] += 20.0 * std::exp(-0.05 * since) * std::sin(0.9 * since + 0.5);
  }
  std::vector<std::size_t> expected = FindLoneSamples(signal);
  for (std::size_t i = 100; i < 3900; i += 190) {
    signal[i] += 10.0;
    expected.push_back(i);
  }
  std::ranges::sort(expected);
  EXPECT_EQ(FindLoneSamples(signal), expected);
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_lone_samples_test
