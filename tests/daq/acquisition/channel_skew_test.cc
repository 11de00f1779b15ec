// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/channel_skew.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::acquisition::channel_skew_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRate_hz = 10000;

// A shaft that speeds up, slows down and turns back, in rad; any moment, so that a delay needs no sampling.
double ShaftAngle_rad(double t) {
  return 4 * std::sin(2 * kPi * 0.7 * t) + 0.6 * std::sin(2 * kPi * 3.1 * t + 1) +
         0.02 * std::sin(2 * kPi * 47 * t);
}

struct Pair {
  std::vector<double> first, second;
};
Pair TwoEncoders(double skew_s, double noise_rad, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0, noise_rad);
  constexpr double kStep_rad = 2 * kPi / 65536;
  const auto read = [&](double t) {
    return std::round((ShaftAngle_rad(t) + noise(random)) / kStep_rad) * kStep_rad;
  };
  Pair pair;
  for (int i = 0; i < 20000; ++i) {
    pair.first.push_back(read(i / kRate_hz));
    pair.second.push_back(1.02 * read(i / kRate_hz - skew_s) + 0.3);
  }
  return pair;
}

TEST(SkewByCorrelation, FindsFractionsOfASampleToAMicrosecond) {
  for (const double skew_s : {0.0, 3e-6, -37e-6, 150e-6, 1e-3, -2.345678e-3}) {
    const Pair pair = TwoEncoders(skew_s, 2e-5, 5);
    const std::optional<Skew> skew = SkewByCorrelation(pair.first, pair.second, kRate_hz, 5e-3);
    ASSERT_TRUE(skew) << skew_s;
    EXPECT_NEAR(skew->skew_s, skew_s, 1e-6);
    EXPECT_LT(skew->standard_error_s, 1e-6);
  }
}

TEST(SkewByCorrelation, StatesAnErrorThatHolds) {
  int within_two = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const Pair pair = TwoEncoders(137e-6, 1e-3, seed);
    const std::optional<Skew> skew = SkewByCorrelation(pair.first, pair.second, kRate_hz, 2e-3);
    ASSERT_TRUE(skew);
    within_two += std::abs(skew->skew_s - 137e-6) < 2 * skew->standard_error_s;
  }
  std::printf("within two standard errors: %d of 60\n", within_two);
  EXPECT_GE(within_two, 52);  // of 57 expected
}

TEST(SkewByCorrelation, SaysNothingWhereTheSignalsDoNot) {
  const std::vector<double> still(1000, 1.0);
  EXPECT_FALSE(SkewByCorrelation(still, still, kRate_hz, 5e-3));
  // At constant speed a delay and an offset are the same.
  std::vector<double> ramp(2000);
  for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = 0.01 * static_cast<double>(i);
  EXPECT_FALSE(SkewByCorrelation(ramp, ramp, kRate_hz, 5e-3));
  Pair pair = TwoEncoders(0, 0, 1);
  pair.second[5000] = NAN;
  EXPECT_FALSE(SkewByCorrelation(pair.first, pair.second, kRate_hz, 5e-3));
  EXPECT_EQ(MessageOf<std::invalid_argument>([&] { SkewByCorrelation(still, still, kRate_hz, 0.1); }),
            "1000 values are not four times the longest skew, 1001 samples");
  EXPECT_EQ(MessageOf<std::invalid_argument>([&] { SkewByCorrelation(still, ramp, kRate_hz, 0.001); }),
            "1000 and 2000 values are not as many");
}

TEST(SkewByRegression, TellsASkewFromAnEccentricity) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> noise(0, 1e-5);
  std::vector<double> speed, difference;
  for (const double rpm : {-1000.0, -500.0, -100.0, 100.0, 500.0, 1000.0}) {
    const double output_rad_per_s = rpm * 2 * kPi / 60 / 80;
    for (int i = 0; i < 400; ++i) {
      speed.push_back(output_rad_per_s);
      difference.push_back(-1e-3 * output_rad_per_s + 2e-4 * std::sin(2 * kPi * i / 400) + 5e-4 +
                           noise(random));
    }
  }
  const std::optional<Skew> skew = SkewByRegression(speed, difference);
  ASSERT_TRUE(skew);
  EXPECT_NEAR(skew->skew_s, 1e-3, 1e-5);
  EXPECT_LT(std::abs(skew->skew_s - 1e-3), 3 * skew->standard_error_s);
  // docs/effects.md E20: 1 ms at 1000 rpm is 4.5 arcmin at the output.
  EXPECT_NEAR(skew->skew_s * 1000 * 2 * kPi / 60 / 80 * 180 / kPi * 60, 4.5, 0.05);
  EXPECT_FALSE(SkewByRegression(std::vector(9, 1.0), std::vector(9, 2.0)));
  EXPECT_FALSE(SkewByRegression(std::vector{1.0, 2.0}, std::vector{1.0, 2.0}));
}

TEST(ShiftInTime, TakesAMeasuredSkewOut) {
  const Pair pair = TwoEncoders(437e-6, 0, 1);
  const double skew_s = SkewByCorrelation(pair.first, pair.second, kRate_hz, 5e-3)->skew_s;
  const std::vector<double> straight = ShiftInTime(pair.second, kRate_hz, skew_s);
  double worst = 0;
  for (std::size_t i = 10; i + 10 < straight.size(); ++i) {
    worst = std::max(
        worst, std::abs((straight[i] - 0.3) / 1.02 - ShaftAngle_rad(static_cast<double>(i) / kRate_hz)));
  }
  EXPECT_LT(worst, 2e-4);  // two steps of the encoder; 10 us at the top speed would be 3e-4
  EXPECT_TRUE(std::isnan(straight.back()));
}

TEST(ShiftInTime, IsExactForACubic) {
  std::vector<double> values;
  const auto cubic = [](double t) { return 1 + t - 0.5 * t * t + 0.01 * t * t * t; };
  for (int i = 0; i < 20; ++i) values.push_back(cubic(i));
  const std::vector<double> shifted = ShiftInTime(values, 1.0, 0.37);
  for (std::size_t i = 1; i < 18; ++i) EXPECT_NEAR(shifted[i], cubic(static_cast<double>(i) + 0.37), 1e-11);
  EXPECT_TRUE(std::isnan(shifted[0]));
}

TEST(OnTimeBase, ReadsAChannelAtOtherTimes) {
  std::vector<double> times, values, wanted;
  const auto cubic = [](double t) { return 2 - t + 0.25 * t * t * t; };
  for (int i = 0; i < 50; ++i) {
    times.push_back(0.1 * i + 0.01 * std::sin(i));
    values.push_back(cubic(times.back()));
    wanted.push_back(0.1 * i + 0.03);
  }
  const std::vector<double> read = OnTimeBase(times, values, wanted);
  for (std::size_t i = 2; i < 47; ++i) EXPECT_NEAR(read[i], cubic(wanted[i]), 1e-11);
  EXPECT_TRUE(std::isnan(read[0]));
  EXPECT_TRUE(std::isnan(read[49]));
  times[3] = times[2];
  EXPECT_EQ(MessageOf<std::invalid_argument>([&] { OnTimeBase(times, values, wanted); }),
            "times_s does not rise");
}

}  // namespace
}  // namespace strainwave::daq::acquisition::channel_skew_test
