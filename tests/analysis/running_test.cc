// SPDX-License-Identifier: Apache-2.0
// Vibrations of a shaft that turns in a part of the record alone.
#include "analysis/samples/running.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "analysis/units.h"

namespace strainwave::analysis::samples::running_test {
namespace {

using Channels = std::vector<std::vector<double>>;

constexpr std::size_t kRows = 7000;
constexpr double kRowsPerTurn = 131.7;

// Noise of 0.4, and where the shaft turns its lines at 1 and 2 per turn.
std::vector<double> Channel(const Segment& turning, double first, double second, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 0.4);
  std::vector<double> values;
  for (std::size_t i = 0; i < kRows; ++i) {
    const double angle = kTwoPi * static_cast<double>(i) / kRowsPerTurn + 0.4;
    const bool turns = i >= turning.first && i < turning.end;
    values.push_back((turns ? first * std::cos(angle) + second * std::sin(2.0 * angle) : 0.0) +
                     noise(random));
  }
  return values;
}

TEST(TurningByLines, FindsWhereTheShaftBeginsAndEndsToTurn) {
  for (const Segment& truth : {Segment{2211, kRows}, Segment{0, 4980}, Segment{1500, 6100}}) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
      const Channels channels{Channel(truth, 0.6, 0.5, seed), Channel(truth, 0.4, 0.9, seed + 100)};
      const Segment found = TurningByLines(channels, kRowsPerTurn);
      // No row in which it stands; of the others a few turns may be lost at either side.
      EXPECT_GE(found.first, truth.first) << seed;
      EXPECT_LE(found.end, truth.end) << seed;
      EXPECT_LT(truth.end - found.end + found.first - truth.first, 13 * kRowsPerTurn) << seed;
    }
  }
}

TEST(TurningByLines, FindsThatAShortRecordBeginsBeforeTheShaftTurns) {
  const auto rows = static_cast<std::size_t>(17.0 * kRowsPerTurn);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::vector<double> values = Channel({static_cast<std::size_t>(2.1 * kRowsPerTurn), rows}, 2.0, 1.0, seed);
    values.resize(rows);
    const Segment found = TurningByLines(Channels{values}, kRowsPerTurn);
    EXPECT_GE(found.first, static_cast<std::size_t>(2.1 * kRowsPerTurn)) << seed;
    EXPECT_LT(found.first, static_cast<std::size_t>(5.1 * kRowsPerTurn)) << seed;
    EXPECT_EQ(found.end, rows) << seed;
  }
}

TEST(TurningByLines, LeavesAShaftThatTurnsAllTheTimeAsItIs) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const Segment all{0, kRows};
    EXPECT_EQ(TurningByLines(Channels{Channel(all, 0.5, 0.5, seed)}, kRowsPerTurn), all) << seed;
    EXPECT_EQ(TurningByLines(Channels{Channel(all, 0.02, 0.06, seed)}, kRowsPerTurn), all) << seed;
    EXPECT_EQ(TurningByLines(Channels{Channel({0, 0}, 0.0, 0.0, seed)}, kRowsPerTurn), all) << seed;
  }
}

// A line at 1 per turn that swells and fades, by a neighbour 0.02 of an order away.
TEST(TurningByLines, DoesNotTakeABeatForAStandstill) {
  std::vector<double> values = Channel({0, kRows}, 1.0, 0.3, 7);
  for (std::size_t i = 0; i < kRows; ++i)
    values[i] += 0.8 * std::cos(1.02 * kTwoPi * static_cast<double>(i) / kRowsPerTurn);
  EXPECT_EQ(TurningByLines(Channels{values}, kRowsPerTurn), (Segment{0, kRows}));
}

TEST(TurningBySpeed, FindsTheLongestSegmentBeyondAHundredthOfTheLargestSpeed) {
  std::vector<double> speed(3000, -150.0);
  for (std::size_t i = 0; i < 400; ++i) speed[i] = 0.2;
  for (std::size_t i = 2700; i < 3000; ++i) speed[i] = -1.2;
  EXPECT_EQ(TurningBySpeed(speed), (Segment{400, 2700}));
}

TEST(TurningBySpeed, LeavesARunUpFromRestAsItIs) {
  std::vector<double> speed;
  for (int i = 0; i < 3000; ++i) speed.push_back(0.1 * i);
  EXPECT_EQ(TurningBySpeed(speed), (Segment{0, 3000}));
}

}  // namespace
}  // namespace strainwave::analysis::samples::running_test
