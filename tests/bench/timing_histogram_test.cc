// SPDX-License-Identifier: Apache-2.0
#include "bench/realtime/timing_histogram.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace strainwave::bench::timing_histogram_test {
namespace {

using std::chrono::nanoseconds;

TEST(TimingHistogram, TellsPercentilesOfSortedDurationsWithinABin) {
  std::mt19937_64 random(5);
  std::lognormal_distribution<double> spread(std::log(1e6), 1.5);
  std::vector<std::int64_t> durations;
  TimingHistogram histogram;
  for (int i = 0; i < 20000; ++i) {
    durations.push_back(static_cast<std::int64_t>(spread(random)));
    histogram.Add(nanoseconds(durations.back()));
  }
  std::ranges::sort(durations);
  for (const double share : {0.01, 0.5, 0.9, 0.99, 0.999}) {
    const auto at = static_cast<std::size_t>(std::ceil(share * 20000.0)) - 1;
    const auto exact = static_cast<double>(durations[at]);
    const auto told = static_cast<double>(histogram.Percentile(share).count());
    EXPECT_GE(told, exact) << share;
    EXPECT_LE(told, 1.07 * exact) << share;
  }
  EXPECT_EQ(histogram.Percentile(1.0).count(), durations.back());
  EXPECT_EQ(histogram.longest().count(), durations.back());
  EXPECT_EQ(histogram.count(), 20000u);
}

TEST(TimingHistogram, IsExactForAFewNanosecondsAndTakesAnyDuration) {
  TimingHistogram histogram;
  EXPECT_EQ(histogram.Percentile(0.5), nanoseconds(0));
  histogram.Add(nanoseconds(-7));
  for (const int value : {3, 15, 16, 17, 31}) histogram.Add(nanoseconds(value));
  EXPECT_EQ(histogram.Percentile(0.0), nanoseconds(0));
  EXPECT_EQ(histogram.Percentile(2.0 / 6.0), nanoseconds(3));
  EXPECT_EQ(histogram.Percentile(3.0 / 6.0), nanoseconds(15));
  EXPECT_EQ(histogram.Percentile(4.0 / 6.0), nanoseconds(16));
  EXPECT_EQ(histogram.Percentile(1.0), nanoseconds(31));
  histogram.Add(nanoseconds::max());
  EXPECT_EQ(histogram.Percentile(1.0), nanoseconds::max());
}

TEST(TimingHistogram, SaysItInOneLine) {
  TimingHistogram histogram;
  for (int i = 0; i < 1000; ++i) histogram.Add(std::chrono::milliseconds(i == 7 ? 3 : 1));
  EXPECT_EQ(histogram.Text(), "p50 1.016 ms, p99 1.016 ms, p99.9 1.016 ms, max 3.000 ms of 1000");
}

}  // namespace
}  // namespace strainwave::bench::timing_histogram_test
