// SPDX-License-Identifier: Apache-2.0
#include "analysis/rainflow.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace strainwave::analysis::rainflow_test {
namespace {

// Cycles by range, which is exact for the loads of these tests.
std::map<double, double> ByRange(const std::vector<RainflowRange>& ranges) {
  std::map<double, double> cycles;
  for (const RainflowRange& range : ranges) cycles[range.range] += range.cycles;
  return cycles;
}

std::vector<double> RandomLoads(unsigned seed, int count) {
  std::mt19937 draw(seed);
  std::vector<double> loads;
  double at = 0.0;
  for (int i = 0; i < count; ++i) {
    at = 0.8 * at + static_cast<double>(draw() % 2001) - 1000.0 + 1e-3 * static_cast<double>(draw() % 1000);
    loads.push_back(at);
  }
  return loads;
}

// By another way: of all ranges that lie within both of their neighbours the smallest is taken out as a
// cycle, until there is none; the rest are halves.
std::map<double, double> SmallestFirst(std::vector<double> loads) {
  for (std::size_t i = 1; i + 1 < loads.size();) {
    const bool is_between = (loads[i] - loads[i - 1]) * (loads[i + 1] - loads[i]) >= 0.0;
    is_between ? loads.erase(loads.begin() + static_cast<std::ptrdiff_t>(i)), 0 : ++i;
  }
  std::map<double, double> cycles;
  for (;;) {
    std::size_t smallest = 0;
    for (std::size_t i = 1; i + 2 < loads.size(); ++i) {
      const double range = std::abs(loads[i + 1] - loads[i]);
      const bool is_within =
          range <= std::abs(loads[i] - loads[i - 1]) && range <= std::abs(loads[i + 2] - loads[i + 1]);
      if (is_within && (smallest == 0 || range < std::abs(loads[smallest + 1] - loads[smallest])))
        smallest = i;
    }
    if (smallest == 0) break;
    const auto at = loads.begin() + static_cast<std::ptrdiff_t>(smallest);
    cycles[std::abs(at[1] - at[0])] += 1.0;
    loads.erase(at, at + 2);
  }
  for (std::size_t i = 1; i < loads.size(); ++i) cycles[std::abs(loads[i] - loads[i - 1])] += 0.5;
  return cycles;
}

TEST(CountRainflow, GivesTheWorkedExampleOfTheStandard) {
  const std::vector<double> loads{-2, 1, -3, 5, -1, 3, -4, 4, -2};
  const std::map<double, double> expected{{3, 0.5}, {4, 1.5}, {6, 0.5}, {8, 1.0}, {9, 0.5}};
  const std::vector<RainflowRange> ranges = CountRainflow(loads);
  EXPECT_EQ(ByRange(ranges), expected);
  const auto whole = std::ranges::find(ranges, 1.0, &RainflowRange::cycles);
  ASSERT_NE(whole, ranges.end());
  EXPECT_EQ(whole->range, 4.0);
  EXPECT_EQ(whole->mean, 1.0);  // of the example's E-F, from -1 to 3
}

TEST(CountRainflow, CountsWhatTakingOutTheSmallestFirstCounts) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const std::vector<double> loads = RandomLoads(seed, 200);
    EXPECT_EQ(ByRange(CountRainflow(loads)), SmallestFirst(loads)) << "seed " << seed;
  }
}

TEST(CountRainflow, IsTheSameOfAHistoryInParts) {
  const std::vector<double> loads = RandomLoads(7, 500);
  for (const std::size_t length : {1U, 2U, 3U, 7U, 100U}) {
    std::vector<double> open;
    std::vector<RainflowRange> counted;
    for (std::size_t from = 0; from < loads.size(); from += length) {
      const std::size_t to = std::min(loads.size(), from + length);
      open.insert(open.end(), loads.begin() + static_cast<std::ptrdiff_t>(from),
                  loads.begin() + static_cast<std::ptrdiff_t>(to));
      const RainflowPart part = CountRainflowPart(open);
      counted.insert(counted.end(), part.closed.begin(), part.closed.end());
      open = part.open;
    }
    const std::vector<RainflowRange> rest = CountRainflow(open);
    counted.insert(counted.end(), rest.begin(), rest.end());
    EXPECT_EQ(ByRange(counted), ByRange(CountRainflow(loads))) << "parts of " << length;
  }
}

TEST(CountRainflow, LooksAtReversalsAlone) {
  EXPECT_EQ(ByRange(CountRainflow(std::vector<double>{0, 1, 1, 2, 4, 4, 1, 0, 0})),
            (std::map<double, double>{{4, 1.0}}));
  EXPECT_TRUE(CountRainflow(std::vector<double>{}).empty());
  EXPECT_TRUE(CountRainflow(std::vector<double>{3, 3, 3}).empty());
}

TEST(CountRainflow, RefusesALoadThatIsNotFinite) {
  try {
    CountRainflow(std::vector<double>{0, std::numeric_limits<double>::quiet_NaN()});
    FAIL() << "it was taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(std::string(error.what()), "load = nan is not finite");
  }
}

TEST(EquivalentCycles, WeighRangesByTheirPower) {
  const std::vector<RainflowRange> ranges{{4.0, 0.0, 1.5}, {8.0, 0.0, 0.5}};
  EXPECT_EQ(EquivalentCycles(ranges, 8.0, 3.0), 1.5 / 8.0 + 0.5);
  EXPECT_EQ(EquivalentCycles(ranges, 8.0, 0.0), 2.0);
  EXPECT_THROW(EquivalentCycles(ranges, 0.0, 3.0), std::invalid_argument);
}

}  // namespace
}  // namespace strainwave::analysis::rainflow_test
