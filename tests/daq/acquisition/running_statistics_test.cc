// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/running_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/daq/acquisition/sample_blocks.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::acquisition::running_statistics_test {
namespace {

// By the definitions, over all values at once, in the longest floats there are.
struct Direct {
  long double mean{}, variance{}, rms{}, peak{}, kurtosis{};
};
Direct DirectOf(const std::vector<double>& values) {
  Direct direct;
  const auto n = static_cast<long double>(values.size());
  long double squares = 0, m2 = 0, m4 = 0;
  for (const double value : values) {
    direct.mean += value / n;
    squares += static_cast<long double>(value) * value;
    direct.peak = std::max(direct.peak, std::abs(static_cast<long double>(value)));
  }
  for (const double value : values) {
    const long double d = value - direct.mean;
    m2 += d * d;
    m4 += d * d * d * d;
  }
  direct.variance = m2 / n;
  direct.rms = std::sqrt(squares / n);
  direct.kurtosis = n * m4 / (m2 * m2);
  return direct;
}

void ExpectLike(const RunningStatistics& statistics, const Direct& direct, double tolerance) {
  const auto close = [&](double value, long double expected) {
    EXPECT_NEAR(value, static_cast<double>(expected), tolerance * std::abs(static_cast<double>(expected)));
  };
  close(statistics.mean(), direct.mean);
  close(statistics.variance(), direct.variance);
  close(statistics.rms(), direct.rms);
  close(statistics.kurtosis(), direct.kurtosis);
  close(statistics.crest_factor(), direct.peak / direct.rms);
  EXPECT_EQ(statistics.peak(), static_cast<double>(direct.peak));
}

std::vector<double> Spiky(std::size_t count, double offset, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise;
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i)
    values.push_back(offset + noise(random) * (i % 997 == 0 ? 9 : 1) + (i % 2 == 0 ? 0.1 : 0.0));
  return values;
}

TEST(RunningStatistics, AgreesWithDirectSums) {
  for (const double offset : {0.3, -1e3, 1e7}) {
    const std::vector<double> values = Spiky(1'000'000, offset, 3);
    RunningStatistics statistics;
    for (const double value : values) statistics.Add(value);
    // The values themselves hold 1e7 only to 2e-9 of the noise, so that is not asked of their moments.
    ExpectLike(statistics, DirectOf(values), offset > 1e6 ? 1e-7 : 1e-10);
    EXPECT_EQ(statistics.count(), values.size());
  }
}

TEST(RunningStatistics, GivesTheSamePutTogetherFromParts) {
  const std::vector<double> values = Spiky(100'000, 5, 4);
  RunningStatistics merged;
  std::size_t at = 0;
  for (const std::size_t part : {0UL, 1UL, 7UL, 50'000UL, 49'992UL, 0UL}) {
    RunningStatistics statistics;
    for (std::size_t i = 0; i < part; ++i) statistics.Add(values[at++]);
    merged.Merge(statistics);
  }
  ASSERT_EQ(at, values.size());
  ExpectLike(merged, DirectOf(values), 1e-10);
}

TEST(RunningStatistics, KnowsWhatKnownSignalsHave) {
  RunningStatistics sine, constant, none;
  for (int i = 0; i < 100'000; ++i) {
    sine.Add(3 * std::sin(2 * std::acos(-1.0) * i / 1000));
    constant.Add(-2);
  }
  EXPECT_NEAR(sine.rms(), 3 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(sine.crest_factor(), std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(sine.kurtosis(), 1.5, 1e-12);
  EXPECT_EQ(constant.rms(), 2);
  EXPECT_EQ(constant.peak(), 2);
  EXPECT_TRUE(std::isnan(constant.kurtosis()));
  EXPECT_TRUE(std::isnan(none.rms()));
  EXPECT_TRUE(std::isnan(none.peak()));
}

TEST(RunningStatistics, LeavesOutWhatIsNoNumberAndCountsIt) {
  RunningStatistics statistics, other;
  statistics.Add(NAN);
  other.Add(1);
  other.Add(-INFINITY);
  statistics.Merge(other);
  EXPECT_EQ(statistics.not_finite(), 2U);
  EXPECT_EQ(statistics.count(), 1U);
  EXPECT_EQ(statistics.mean(), 1);
}

TEST(RunningStatistics, TakesEachChannelOfABlock) {
  const SourceDescription source = SourceOf(3, 1000, SampleType::kInt32);
  std::vector<RunningStatistics> channels(3);
  AddBlock(
      BlockAt(source, 0, 5,
              [](std::uint64_t n, std::size_t c) { return static_cast<double>(n) * (c == 1 ? -10 : 1); }),
      channels);
  EXPECT_EQ(channels[0].mean(), 2);
  EXPECT_EQ(channels[1].least(), -40);
  EXPECT_EQ(channels[1].most(), 0);
  EXPECT_EQ(channels[2].count(), 5U);
  channels.pop_back();
  EXPECT_EQ(
      MessageOf<std::invalid_argument>([&] { AddBlock(BlockAt(source, 0, 5, SampleNumber), channels); }),
      "a block of 3 channels, 2 expected");
}

}  // namespace
}  // namespace strainwave::daq::acquisition::running_statistics_test
