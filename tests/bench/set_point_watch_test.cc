// SPDX-License-Identifier: Apache-2.0
#include "bench/safety/set_point_watch.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "analysis/units.h"

namespace strainwave::bench::set_point_watch_test {
namespace {

constexpr double kPeriod_s = 0.01;

std::chrono::nanoseconds ToTime(double time_s) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(time_s));
}

// Steps a watch of 15 % of 40 Nm through `time_s`; `asked` and `measured` over time.
struct Torque {
  std::function<double(double)> asked = [](double) { return 40.0; };
  std::function<double(double)> measured;

  // When it was away for too long; a NaN where it never was.
  double TripsAt(double time_s, double dwell_s = 2.0) const {
    SetPointWatch watch(6.0, dwell_s);
    for (double time = kPeriod_s; time <= time_s; time += kPeriod_s) {
      watch.Step(asked(time), measured(time), ToTime(time), kPeriod_s);
      if (watch.is_away_for_too_long()) return time;
    }
    return std::nan("");
  }
};

// To and fro between two torques: 1.5 s each way with a ramp of 0.4 s.
double Reversing(double time_s) {
  const double in_period_s = std::fmod(time_s, 3.0);
  const double sign = in_period_s < 1.5 ? 1.0 : -1.0;
  const double in_turn_s = std::fmod(in_period_s, 1.5);
  return sign * (in_turn_s < 0.4 ? -40.0 + 200.0 * in_turn_s : 40.0);
}

TEST(SetPointWatch, LetsTheGearRippleAboutItsMean) {
  Torque torque;
  torque.measured = [](double time_s) { return 38.0 + 20.0 * std::sin(kTwoPi * 17.0 * time_s); };
  EXPECT_TRUE(std::isnan(torque.TripsAt(60.0)));
}

TEST(SetPointWatch, LetsAServoLagBehindARamp) {
  Torque torque;
  torque.asked = Reversing;
  torque.measured = [](double time_s) { return Reversing(std::max(0.0, time_s - 0.1)); };
  EXPECT_TRUE(std::isnan(torque.TripsAt(60.0)));
}

TEST(SetPointWatch, TripsAfterItsDwellInBothDirections) {
  Torque torque;
  for (const double measured_Nm : {8.0, 33.0, 47.0, -40.0, 0.0}) {
    torque.measured = [&](double) { return measured_Nm; };
    EXPECT_NEAR(torque.TripsAt(10.0), 2.0, 2.5 * kPeriod_s) << measured_Nm;
  }
  torque.measured = [&](double) { return std::nan(""); };
  EXPECT_NEAR(torque.TripsAt(10.0), 2.0, 2.5 * kPeriod_s);
}

// 1.5 s each way, of which 0.8 are a ramp and what a servo may need after it: three ways and a bit.
TEST(SetPointWatch, AddsUpWhatIsAwayBetweenReversals) {
  Torque torque;
  torque.asked = Reversing;
  torque.measured = [](double time_s) { return std::clamp(Reversing(time_s), -8.0, 8.0); };
  EXPECT_NEAR(torque.TripsAt(60.0), 5.0, 1.0);
}

TEST(SetPointWatch, ForgetsWhatWasAwayOnceForAsLong) {
  Torque torque;
  torque.measured = [](double time_s) { return std::fmod(time_s, 4.0) < 1.5 ? 8.0 : 40.0; };
  EXPECT_TRUE(std::isnan(torque.TripsAt(120.0)));
}

// The network was held up just after a ripple's peak: a dwell of a tenth of a second had passed before the
// next sample came, which is near.
TEST(SetPointWatch, CountsASampleOnceHoweverLongItIsTheNewest) {
  SetPointWatch watch(1.5, 0.1);
  for (int step = 0; step < 100; ++step)
    watch.Step(0.0, 0.0, std::chrono::milliseconds(10 * step), kPeriod_s);
  for (int step = 100; step < 105; ++step)
    watch.Step(0.0, 6.0, std::chrono::milliseconds(10 * step), kPeriod_s);
  ASSERT_TRUE(watch.away());
  for (int step = 0; step < 13; ++step) watch.Step(0.0, 6.0, std::chrono::milliseconds(1040), kPeriod_s);
  EXPECT_FALSE(watch.is_away_for_too_long());
  watch.Step(0.0, 0.0, std::chrono::milliseconds(1180), kPeriod_s);
  EXPECT_FALSE(watch.away());
  EXPECT_FALSE(watch.is_away_for_too_long());
}

schedules::Specimen Size20() {
  schedules::Specimen specimen;
  specimen.rated_torque_Nm = 30.0;
  return specimen;
}

TEST(LoadWatch, SaysWhichServoIsAwayByTransducerAndEncoder) {
  const double asked_rad_per_s = RadPerSFromRpm(2400.0);
  for (const bool torque_is_short : {true, false}) {
    LoadWatch watch({}, 40.0, asked_rad_per_s, Size20());
    const double speed_rad_per_s = torque_is_short ? asked_rad_per_s : RadPerSFromRpm(608.0);
    for (int step = 1; step < 500 && !watch.failed(); ++step) {
      Readings readings;
      readings.time = std::chrono::milliseconds(10) * step;
      readings.SetSampleTimes(readings.time);
      readings.input_angle_rad = speed_rad_per_s * 0.01 * step;
      readings.input_speed_rad_per_s = asked_rad_per_s;  // as the drive says
      readings.output_torque_Nm = torque_is_short ? 8.0 : 40.0;
      watch.Step(40.0, asked_rad_per_s, readings, kPeriod_s);
    }
    EXPECT_EQ(
        Describe(watch.failed()),
        torque_is_short
            ? "the load servo gives 8.0 of 40.0 Nm: its torque limit, coupling or current?"
            : "the driving servo turns at 608 of 2400 rpm: its speed or torque limit, coupling or current?");
  }
}

// Two blocks of a stream 1 and 19 ms apart instead of 10 and 10.
TEST(LoadWatch, KnowsTheSpeedWhereSamplesComeInPairs) {
  const double asked_rad_per_s = RadPerSFromRpm(2400.0);
  LoadWatch watch({}, 40.0, asked_rad_per_s, Size20());
  for (int step = 1; step < 500; ++step) {
    Readings readings;
    readings.time = readings.torque_time = std::chrono::milliseconds(10) * step;
    readings.input_angle_time = readings.time + std::chrono::milliseconds(step % 2 == 0 ? -9 : 0);
    readings.input_angle_rad = asked_rad_per_s * 0.01 * step;
    readings.output_torque_Nm = 40.0;
    watch.Step(40.0, asked_rad_per_s, readings, kPeriod_s);
    ASSERT_EQ(Describe(watch.failed()), Describe({}));
    ASSERT_FALSE(step > 20 && watch.away())
        << RpmFromRadPerS(watch.input_speed_rad_per_s()) << " rpm in step " << step;
  }
}

TEST(LoadWatch, AllowsOfASmallTorqueAShareOfAThirdOfTheRatedOne) {
  const schedules::SetPointTolerances tolerances;
  EXPECT_DOUBLE_EQ(TorqueTolerance_Nm(tolerances, 40.0, Size20()), 6.0);
  EXPECT_DOUBLE_EQ(TorqueTolerance_Nm(tolerances, -40.0, Size20()), 6.0);
  EXPECT_DOUBLE_EQ(TorqueTolerance_Nm(tolerances, 1.0, Size20()), 1.5);
}

TEST(PositionAway, TellsAnInputThatDidNotFollow) {
  Readings readings;
  readings.input_angle_rad = 10.0 - RadFromDeg(89.0);
  EXPECT_FALSE(PositionAway(10.0, readings));
  readings.input_angle_rad = 10.0 - RadFromDeg(100.0);
  EXPECT_EQ(Describe(PositionAway(10.0, readings)),
            "the input is -100.0 deg from where the driving servo was sent (at most 90.0 deg): its speed or "
            "torque limit, coupling or current?");
}

// Whatever stands away at this moment, before its dwell is over.
TEST(LoadWatch, SaysWhatIsAwayAtThisMoment) {
  schedules::SetPointTolerances tolerances;
  tolerances.torque_share = 0.15;
  tolerances.speed_share = 0.05;
  tolerances.dwell_s = 1000.0;
  schedules::Specimen specimen;
  specimen.rated_torque_Nm = 34.0;
  const auto away = [&](double torque_Nm, double speed_rad_per_s) {
    LoadWatch watch(tolerances, 40.0, 100.0, specimen);
    Readings readings;
    for (int period = 1; period <= 1000; ++period) {
      // The encoder's newest sample is there for two periods.
      readings.time = readings.torque_time = ToTime(kPeriod_s * period);
      readings.input_angle_time = ToTime(kPeriod_s * (period - period % 2));
      readings.input_angle_rad = speed_rad_per_s * kPeriod_s * (period - period % 2);
      readings.output_torque_Nm = torque_Nm;
      watch.Step(40.0, 100.0, readings, kPeriod_s);
    }
    return watch.away_reason().cause;
  };
  EXPECT_EQ(away(40.0, 100.0), StopCause::kNone);
  EXPECT_EQ(away(20.0, 100.0), StopCause::kTorqueAway);
  EXPECT_EQ(away(40.0, 50.0), StopCause::kSpeedAway);
  EXPECT_EQ(away(20.0, 50.0), StopCause::kTorqueAway);
}

}  // namespace
}  // namespace strainwave::bench::set_point_watch_test
