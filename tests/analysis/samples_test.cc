// SPDX-License-Identifier: Apache-2.0
// What loggers and encoders do to samples, found in signals that are made here and spoiled on purpose.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "analysis/samples/arrivals.h"
#include "analysis/samples/holds.h"
#include "analysis/samples/resolution.h"
#include "analysis/samples/stamps.h"
#include "analysis/samples/wraps.h"
#include "analysis/units.h"
#include "tests/analysis/chance.h"

namespace strainwave::analysis::samples::samples_test {
namespace {

// A slow way to and fro with noise.
std::vector<double> Way(std::size_t count, double size, double noise, unsigned seed = 3) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count);
    values.push_back(size * (std::sin(9.0 * share) + 0.4 * std::sin(31.0 * share)) + noise * normal(random));
  }
  return values;
}

std::vector<double> Wrapped(std::vector<double> values, double modulus, double low) {
  for (double& value : values) value -= modulus * std::floor((value - low) / modulus);
  return values;
}

void ExpectSameWay(const std::vector<double>& values, const std::vector<double>& truth) {
  ASSERT_EQ(values.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i)
    ASSERT_NEAR(values[i] - values[0], truth[i] - truth[0], 1e-9) << i;
}

TEST(FindWraps, FindsAnAngleThatStartsAnewWhateverItsModulus) {
  // A small loop about the zero, and many turns; whole turns, parts of one, several in one.
  for (const auto& [size_deg, modulus_deg, low_deg] :
       {std::tuple{0.2, 360.0, 0.0}, std::tuple{3000.0, 360.0, 0.0}, std::tuple{3000.0, 360.0, -180.0},
        std::tuple{2.0, 45.0, 0.0}, std::tuple{4000.0, 720.0, 0.0}, std::tuple{1.0, 1474560.0, 0.0}}) {
    const std::vector<double> truth = Way(4000, size_deg, 0.002 * size_deg);
    std::vector<double> values = Wrapped(truth, modulus_deg, low_deg);
    const auto wraps = FindWraps(values, 360.0);
    ASSERT_TRUE(wraps) << modulus_deg;
    EXPECT_EQ(wraps->modulus, modulus_deg);
    Unwrap(values, wraps->modulus);
    ExpectSameWay(values, truth);
  }
}

TEST(FindWraps, LeavesAnAngleThatGoesOnAlone) {
  EXPECT_FALSE(FindWraps(Way(4000, 3000.0, 0.1), 360.0));
  EXPECT_FALSE(FindWraps(Way(4000, 0.2, 0.01), 360.0));
  std::vector<double> bad_sample = Way(400, 100.0, 0.01);
  bad_sample[200] += 300.0;
  EXPECT_FALSE(FindWraps(bad_sample, 360.0));
  std::vector<double> twice;  // a sweep that is driven again
  std::vector<bool> returns;
  for (int i = 0; i < 720; ++i) {
    twice.push_back(i % 360);
    returns.push_back(i == 360);
  }
  EXPECT_FALSE(FindWraps(twice, 360.0, returns));
}

TEST(UnwrapAlong, TellsTurnsThatTheStepsAloneDoNot) {
  std::vector<double> truth_deg;
  std::vector<double> expected_deg;
  for (int i = 0; i <= 144; ++i) {  // 200 deg a row
    truth_deg.push_back(200.0 * i + 3.0 * std::sin(0.1 * i));
    expected_deg.push_back(200.0);
  }
  std::vector<double> values = Wrapped(truth_deg, 360.0, 0.0);
  EXPECT_LT(UnwrapAlong(values, 360.0, expected_deg), 0.01);
  ExpectSameWay(values, truth_deg);
  values = Wrapped(truth_deg, 360.0, 0.0);
  const std::vector<double> wrong_deg(truth_deg.size(), 160.0);
  EXPECT_GT(UnwrapAlong(values, 360.0, wrong_deg), 0.1);
}

std::vector<double> HeldFor(const std::vector<double>& values, std::size_t rows) {
  std::vector<double> held;
  for (std::size_t i = 0; i < values.size(); ++i) held.push_back(values[i / rows * rows]);
  return held;
}

TEST(FindHeld, FindsAChannelThatIsWrittenAgainUntilItsNextValueComes) {
  for (const std::size_t rows : {2, 3, 7, 20}) {
    const auto held = FindHeld(HeldFor(Way(3000, 1.0, 0.002), rows));
    ASSERT_TRUE(held) << rows;
    EXPECT_EQ(held->longest, rows);
    for (std::size_t i = 0; i < 3000; ++i) ASSERT_EQ(held->fresh[i], i % rows == 0) << i;
  }
  // A tenth of the rows, here and there.
  std::mt19937 random(8);
  std::vector<double> values = Way(3000, 1.0, 0.002);
  std::size_t repeated = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (random() % 10 != 0) continue;
    values[i] = values[i - 1];
    ++repeated;
  }
  const auto held = FindHeld(values);
  ASSERT_TRUE(held);
  EXPECT_NEAR(static_cast<double>(held->repeated), static_cast<double>(repeated), 3.0);
}

TEST(FindHeld, DoesNotTakeStepsRestsOrCommandsForIt) {
  const auto rounded = [](std::vector<double> values, double step) {
    for (double& value : values) value = step * std::round(value / step);
    return values;
  };
  EXPECT_FALSE(FindHeld(Way(3000, 1.0, 0.002)));
  for (const double step : {1e-4, 1e-3, 4e-3, 0.02, 0.1})
    EXPECT_FALSE(FindHeld(rounded(Way(3000, 1.0, 0.002), step))) << step;
  for (const double step : {1e-4, 1e-3, 0.01})
    EXPECT_FALSE(FindHeld(rounded(Way(3000, 1.0, 0.0), step))) << step;
  std::vector<double> rests = Way(3000, 1.0, 0.0);
  for (std::size_t i = 0; i < rests.size(); ++i) {
    if (i % 300 > 200) rests[i] = rests[i - 1];
  }
  EXPECT_FALSE(FindHeld(rests));
  std::vector<double> command;
  for (int i = 0; i < 3000; ++i) command.push_back(i / 10 % 12);
  EXPECT_FALSE(FindHeld(command));
}

TEST(GoesOnMeanwhile, TellsALoggerFromAStair) {
  const std::vector<double> stair = HeldFor(Way(3000, 1.0, 0.0), 20);
  const auto held = FindHeld(stair);
  ASSERT_TRUE(held);
  EXPECT_NEAR(GoesOnMeanwhile(*held, Way(3000, 5.0, 0.1, 4)), 1.0, 0.2);
  std::vector<double> follower = stair;
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 1e-4);
  for (double& value : follower) value = 3.0 * value + noise(random);
  EXPECT_LT(GoesOnMeanwhile(*held, follower), 0.2);
}

TEST(FindFrozen, FindsASegmentThatItsOwnNoiseWouldNotLetStand) {
  std::vector<double> values = Way(3000, 1.0, 0.05);
  for (double& value : values) value = 1e-3 * std::round(value / 1e-3);
  EXPECT_TRUE(FindFrozen(values).empty());
  for (std::size_t i = 1001; i < 1040; ++i) values[i] = values[1000];
  const auto frozen = FindFrozen(values);
  ASSERT_EQ(frozen.size(), 1U);
  EXPECT_EQ(frozen[0].first, 1000U);
  EXPECT_EQ(frozen[0].count, 40U);
}

TEST(FindFrozen, TellsWhatStoodStillWhileItTurnedBackFromWhatIsClipped) {
  std::vector<double> values;
  for (int i = 0; i <= 2000; ++i) values.push_back(std::abs(i - 1000));
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 0.05);
  for (double& value : values) value = 1e-3 * std::round(1e3 * (value + noise(random)));
  std::vector<double> clipped = values;
  for (double& value : clipped) value = std::max(value, 40.0);
  EXPECT_TRUE(FindFrozen(clipped).empty());
  EXPECT_EQ(FindSaturated(clipped).size(), 1U);
  for (std::size_t i = 961; i < 1080; ++i) values[i] = values[960];  // is at 80 when it goes on
  values[300] = values[1500] = 0.0;                                  // spikes
  const auto frozen = FindFrozen(values);
  ASSERT_EQ(frozen.size(), 1U);
  EXPECT_EQ(frozen[0].first, 960U);
  EXPECT_EQ(frozen[0].count, 120U);
}

TEST(FindFrozen, TellsARestWithoutVisibleNoiseByWhatComesAfterIt) {
  std::vector<double> quiet = Way(3000, 1.0, 1e-4);
  for (double& value : quiet) value = 1e-3 * std::round(value / 1e-3);
  std::vector<double> rests = quiet;
  rests.insert(rests.begin() + 1000, 40, rests[1000]);  // goes on from where it stood
  EXPECT_TRUE(FindFrozen(rests).empty());
  for (std::size_t i = 1001; i < 1040; ++i) quiet[i] = quiet[1000];  // was elsewhere meanwhile
  const auto frozen = FindFrozen(quiet);
  ASSERT_EQ(frozen.size(), 1U);
  EXPECT_EQ(frozen[0].first, 1000U);
  EXPECT_GE(frozen[0].count, 40U);
}

TEST(FindSaturated, FindsTheEndsAtWhichASignalStandsAgainstItsNoise) {
  std::vector<double> values = Way(700, 200.0, 0.3);
  for (double& value : values) value = 1e-3 * std::round(value / 1e-3);
  EXPECT_TRUE(FindSaturated(values).empty());
  for (double& value : values) value = std::min(value, 170.0);
  const auto found = FindSaturated(values);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].at, 170.0);
  EXPECT_EQ(found[0].count, static_cast<std::size_t>(std::ranges::count(values, 170.0)));
  for (double& value : values) value = std::max(value, -90.0);
  EXPECT_EQ(FindSaturated(values).size(), 2U);
}

TEST(FindSaturated, FindsTheEndOfSeveralPeaksEachOfWhichIsShort) {
  // Three peaks of a ramp, of which four samples each stand: one of them alone may be chance.
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<double> values;
  for (int i = 0; i < 1200; ++i) {
    const double peaked = std::abs(std::remainder(i / 200.0, 2.0));  // 0 to 1 and back, three times
    values.push_back(1e-3 * std::round(1e3 * (50.0 * peaked + 0.05 * normal(random))));
  }
  EXPECT_TRUE(FindSaturated(values).empty());
  for (double& value : values) value = std::min(value, 49.4);
  const auto found = FindSaturated(values);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].at, 49.4);
  EXPECT_TRUE(FindSaturated(std::span(values).first(400)).empty());
}

// One loop of torque at 50 samples a second: each end alone may be chance.
TEST(FindSaturated, FindsBothEndsWhereOneSpeaksForTheOther) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::vector<double> values;
  for (int i = 0; i < 720; ++i) {
    const double there = i < 145 ? i / 144.0 : i < 432 ? 1.0 - (i - 144) / 144.0 : (i - 576) / 144.0;
    values.push_back(1e-4 * std::round(1e4 * (92.0 * there + 0.04 * normal(random))));
  }
  EXPECT_TRUE(FindSaturated(values).empty());
  for (double& value : values) value = std::clamp(value, -89.5, 89.5);
  EXPECT_EQ(FindSaturated(values).size(), 2U);
}

// A load that is held between its ends as long as at them.
TEST(FindSaturated, FindsNoneInALoadThatIsHeldElsewhereToo) {
  std::vector<double> values = Way(700, 200.0, 0.3);
  for (double& value : values) value = std::min(1e-3 * std::round(value / 1e-3), 170.0);
  ASSERT_EQ(FindSaturated(values).size(), 1U);
  const auto between = std::ranges::find_if(values, [](double value) { return std::abs(value) < 100.0; });
  values.insert(between, 400, double(*between));
  EXPECT_TRUE(FindSaturated(values).empty());
}

TEST(FindSaturated, FindsNoneWhereStepsAreCoarserThanTheNoise) {
  std::vector<double> values = Way(700, 20.0, 0.1);
  for (double& value : values) value = std::round(value);
  EXPECT_TRUE(FindSaturated(values).empty());
}

TEST(ArrivalTimes, PutsValuesThatComeEvenlyBetweenTheRowsWhereTheyCame) {
  // 100 a second in rows of 250 a second: two and three rows in turn.
  std::vector<double> time_s;
  std::vector<double> held;
  std::vector<double> other;
  std::vector<bool> fresh;
  int last = -1;
  for (int i = 0; i < 1000; ++i) {
    time_s.push_back(0.004 * i);
    const int came = static_cast<int>(std::floor(0.004 * i / 0.01 + 1e-9));
    held.push_back(std::sin(0.01 * came));
    other.push_back(5.0 * 0.004 * i);
    fresh.push_back(came != last);
    last = came;
  }
  const std::vector<double> arrival_s = ArrivalTimes(time_s, fresh);
  const std::vector<double> at = AtArrivals(time_s, other, std::vector<bool>(1000, true), arrival_s, fresh);
  int came = 0;
  for (std::size_t i = 0; i < 1000; ++i) {
    if (!fresh[i]) continue;
    // Where between two rows they came nobody knows: within half a row.
    EXPECT_NEAR(arrival_s[i], 0.01 * came, 0.0021);
    EXPECT_NEAR(at[i], 5.0 * std::max(arrival_s[i], 0.0), 1e-9);
    ++came;
  }
}

TEST(EvenWithinTicks, TakesRoundedStampsAsEvenAndNoOthers) {
  std::vector<double> rounded_s;
  std::vector<double> wandering_s;
  for (int i = 0; i < 2560; ++i) {
    rounded_s.push_back(1e-4 * std::round(i / 12800.0 / 1e-4));
    wandering_s.push_back(1e-4 * std::round((i + 40.0 * std::sin(0.01 * i)) / 12800.0 / 1e-4));
  }
  EXPECT_NEAR(static_cast<double>(RepeatedStamps(rounded_s)), (1.0 - 1e4 / 12800.0) * 2560.0, 1.0)
      << "a tick has 1.28 samples";
  ASSERT_TRUE(EvenWithinTicks(rounded_s));
  // Within a tick of 1e-4 s rounding is even; a line through 2560 stamps is 29 µs · 2 / √2560 off at its
  // ends.
  const double error_s = kByChance * 1e-4 / std::sqrt(12.0) * 2.0 / std::sqrt(2560.0);
  for (std::size_t i = 0; i < rounded_s.size(); ++i)
    ASSERT_NEAR(rounded_s[i], static_cast<double>(i) / 12800.0, error_s);
  EXPECT_FALSE(EvenWithinTicks(wandering_s));
}

TEST(QuantisationStep, IsTheStepOfARoundedSignalAndNoneOfAnother) {
  std::vector<double> values = Way(2000, 1.0, 0.003);
  EXPECT_EQ(QuantisationStep(values), 0.0);
  const double step = kTwoPi / 65536.0;
  for (double& value : values) value = step * std::round(value / step);
  EXPECT_NEAR(QuantisationStep(values), step, 1e-9);
}

TEST(QuantisationStepOfSweep, IsTheStepOfAnEncoderThatMovesOnByManyOfThem) {
  constexpr double kStep_deg = 360.0 / 16384.0;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<double> fine_deg;
  for (int i = 0; i < 700; ++i) fine_deg.push_back((i < 400 ? 1.0 : 0.5) * i + 0.01 * normal(random));
  EXPECT_EQ(QuantisationStepOfSweep(fine_deg), 0.0);
  std::vector<double> coarse_deg;
  for (const double angle_deg : fine_deg)
    coarse_deg.push_back(1e-9 * std::round(1e9 * kStep_deg * std::round(angle_deg / kStep_deg)));
  EXPECT_EQ(QuantisationStep(coarse_deg), 0.0);
  EXPECT_NEAR(QuantisationStepOfSweep(coarse_deg), kStep_deg, 1e-3 * kStep_deg);
  std::vector<double> in_turn_deg;  // a harmonic at half the steps
  for (int i = 0; i < 700; ++i) in_turn_deg.push_back(i + (i % 2 == 0 ? 0.0 : 0.0121));
  EXPECT_EQ(QuantisationStepOfSweep(in_turn_deg), 0.0);
}

}  // namespace
}  // namespace strainwave::analysis::samples::samples_test
