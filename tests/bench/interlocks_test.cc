// SPDX-License-Identifier: Apache-2.0
#include "bench/safety/interlocks.h"

#include <array>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/units.h"

namespace strainwave::bench::interlocks_test {
namespace {

using std::chrono::milliseconds;

schedules::Limits TestLimits() {
  schedules::Limits limits;
  limits.output_torque_Nm = 60.0;
  limits.input_speed_rad_per_s = RadPerSFromRpm(3000.0);
  limits.gear_temperature_degC = 75.0;
  limits.vibration_rms_m_per_s2 = 50.0;
  limits.twist_rad = RadFromArcmin(30.0);
  return limits;
}

Readings Quiet() {
  Readings readings;
  readings.time = milliseconds(1000);
  readings.output_torque_Nm = 40.0;
  readings.input_speed_rad_per_s = 251.0;
  readings.gear_temperature_degC = 45.0;
  readings.vibration_rms_m_per_s2 = 3.0;
  return readings;
}

InterlockInputs Now() {
  InterlockInputs inputs;
  inputs.now = milliseconds(1000);
  return inputs;
}

const Interlocks kInterlocks(TestLimits(), milliseconds(30));

TEST(Interlocks, LetAQuietBenchRun) { EXPECT_FALSE(kInterlocks.Check(Quiet(), Now())); }

TEST(Interlocks, TripOnEachLimitInBothDirectionsAndSayWhichAndHowMuch) {
  Readings readings = Quiet();
  readings.output_torque_Nm = -60.5;
  StopReason reason = kInterlocks.Check(readings, Now());
  EXPECT_EQ(reason.cause, StopCause::kOutputTorqueLimit);
  EXPECT_EQ(Describe(reason),
            "output torque -60.50 Nm is beyond the limit of 60.00 Nm (limits.output_torque)");

  readings = Quiet();
  readings.input_speed_rad_per_s = RadPerSFromRpm(-3100.0);
  reason = kInterlocks.Check(readings, Now());
  EXPECT_EQ(Describe(reason), "input speed -3100 rpm is beyond the limit of 3000 rpm (limits.input_speed)");

  readings = Quiet();
  readings.gear_temperature_degC = 75.1;
  EXPECT_EQ(kInterlocks.Check(readings, Now()).cause, StopCause::kGearTemperatureLimit);

  readings = Quiet();
  readings.vibration_rms_m_per_s2 = 51.0;
  EXPECT_EQ(kInterlocks.Check(readings, Now()).cause, StopCause::kVibrationLimit);
}

TEST(Interlocks, WatchTheTwistOnlyWhileTheInputIsLocked) {
  InterlockInputs inputs = Now();
  inputs.twist_rad = RadFromArcmin(31.0);
  EXPECT_FALSE(kInterlocks.Check(Quiet(), inputs));
  inputs.input_locked = true;
  EXPECT_EQ(kInterlocks.Check(Quiet(), inputs).cause, StopCause::kTwistLimit);
}

TEST(Interlocks, TakeANotANumberForABrokenLimit) {
  Readings readings = Quiet();
  readings.output_torque_Nm = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(kInterlocks.Check(readings, Now()).cause, StopCause::kOutputTorqueLimit);
}

TEST(Interlocks, TakeAnOldReadingForNoReading) {
  InterlockInputs inputs = Now();
  inputs.now = milliseconds(1030);
  EXPECT_FALSE(kInterlocks.Check(Quiet(), inputs));
  inputs.now = milliseconds(1031);
  EXPECT_EQ(Describe(kInterlocks.Check(Quiet(), inputs)), "no fresh readings for 31 ms (at most 30 ms)");
}

TEST(Interlocks, TripOnADriveFaultOfEitherSide) {
  InterlockInputs inputs = Now();
  inputs.load.power = protocols::PowerState::kFault;
  EXPECT_EQ(Describe(kInterlocks.Check(Quiet(), inputs)), "the load servo reports a fault");
  inputs.driving.power = protocols::PowerState::kFaultReactionActive;
  EXPECT_EQ(Describe(kInterlocks.Check(Quiet(), inputs)), "the driving servo reports a fault");
}

TEST(Interlocks, TripAtOnceWhenAChannelThatGuardsTheSpecimenIsBad) {
  Readings readings = Quiet();
  readings.bad_channels = 1u << static_cast<unsigned>(Channel::kOutputTorque);
  EXPECT_EQ(kInterlocks.Check(readings, Now()).cause, StopCause::kImplausibleReading);
  readings.bad_channels = 1u << static_cast<unsigned>(Channel::kAmbientTemperature);
  EXPECT_FALSE(kInterlocks.Check(readings, Now()));
}

TEST(Interlocks, FindEverythingThatIsBrokenWithTheFirstInFront) {
  Readings readings = Quiet();
  readings.output_torque_Nm = 70.0;
  readings.vibration_rms_m_per_s2 = 60.0;
  std::array<StopReason, 8> causes;
  ASSERT_EQ(kInterlocks.CheckAll(readings, Now(), causes), 2u);
  EXPECT_EQ(causes[0].cause, kInterlocks.Check(readings, Now()).cause);
  EXPECT_EQ(causes[1].cause, StopCause::kVibrationLimit);
}

std::vector<std::string> UnwatchedBy(const BenchSensors& sensors) {
  std::vector<std::string> limits;
  for (const InterlockRow& row : Interlocks::Table(sensors)) {
    if (!row.unwatched.empty()) limits.push_back(std::string(row.signal) + ": " + std::string(row.unwatched));
  }
  return limits;
}

TEST(Interlocks, SayWhatABenchDoesNotWatch) {
  EXPECT_EQ(UnwatchedBy({.vibration = true, .quick_stop_key = true}), std::vector<std::string>());
  EXPECT_EQ(UnwatchedBy({}), (std::vector<std::string>{"vibration RMS: the bench has no accelerometers",
                                                       "quick-stop key: the bench has no pendant"}));
}

schedules::SuspendRule TestRule() {
  schedules::SuspendRule rule;
  rule.trip_temperature_degC = 70.0;
  rule.resume_temperature_degC = 60.0;
  rule.dwell_s = 5.0;
  rule.bad_sensor_s = 2.0;
  return rule;
}

TEST(Describe, ShowsAValueAndItsLimitWithAsManyDecimalsAsTellThemApart) {
  EXPECT_EQ(Describe({StopCause::kTemperatureSuspend, 70.0004, 70.0}),
            "suspended: gear temperature 70.0004 degC is above 70.0000 degC (suspend.trip_temperature)");
  EXPECT_EQ(Describe({StopCause::kSensorStayedBad, 7.0, 1800.0}),
            "the vibration gave no good value again in 0.5 h (suspend.give_up)");
}

TEST(SuspendMonitor, ResumesBelowItsOwnThresholdAfterTheDwell) {
  SuspendMonitor monitor(TestRule());
  Readings readings = Quiet();
  EXPECT_FALSE(monitor.Check(readings, 1.0));
  readings.gear_temperature_degC = 70.5;
  EXPECT_EQ(monitor.Check(readings, 1.0).cause, StopCause::kTemperatureSuspend);
  readings.gear_temperature_degC = 65.0;  // below the trip, above the resume threshold
  for (int second = 0; second < 60; ++second) EXPECT_FALSE(monitor.Recovered(readings, 1.0));
  readings.gear_temperature_degC = 59.0;
  for (int second = 0; second < 4; ++second) EXPECT_FALSE(monitor.Recovered(readings, 1.0));
  readings.gear_temperature_degC = 61.0;  // the dwell begins anew
  EXPECT_FALSE(monitor.Recovered(readings, 1.0));
  readings.gear_temperature_degC = 59.0;
  for (int second = 0; second < 4; ++second) EXPECT_FALSE(monitor.Recovered(readings, 1.0));
  EXPECT_TRUE(monitor.Recovered(readings, 1.0));
}

TEST(SuspendMonitor, ForgivesAShortDropoutButNotALongOne) {
  SuspendMonitor monitor(TestRule());
  Readings readings = Quiet();
  readings.bad_channels = 1u << static_cast<unsigned>(Channel::kAmbientTemperature);
  EXPECT_FALSE(monitor.Check(readings, 1.0));
  EXPECT_FALSE(monitor.Check(readings, 1.0));
  EXPECT_FALSE(monitor.Check(Quiet(), 1.0));  // good again
  EXPECT_FALSE(monitor.Check(readings, 1.0));
  EXPECT_FALSE(monitor.Check(readings, 1.0));
  EXPECT_EQ(monitor.Check(readings, 1.0).cause, StopCause::kSensorSuspend);
}

TEST(Interlocks, TakeTheQuickStopKeyForAStopThatAPersonAskedFor) {
  Readings readings = Quiet();
  readings.quick_stop_pressed = true;
  const StopReason reason = kInterlocks.Check(readings, Now());
  EXPECT_EQ(reason.cause, StopCause::kQuickStopKey);
  EXPECT_TRUE(IsRequest(reason.cause));
  EXPECT_EQ(Describe(reason), "the quick-stop key was pressed, or its pendant is gone");
}

TEST(Interlocks, NameTheChannelThatIsBad) {
  Readings readings = Quiet();
  readings.bad_channels = 1U << static_cast<unsigned>(Channel::kOutputTorque);
  EXPECT_EQ(Describe(kInterlocks.Check(readings, Now())), "the output torque gives no plausible value");
}

constexpr unsigned BitOf(Channel channel) { return 1u << static_cast<unsigned>(channel); }

// A channel without a value cannot be held against its limit: what says so is the channel, not the limit.
TEST(Interlocks, DoNotJudgeALimitByAChannelThatIsBad) {
  for (const Channel channel :
       {Channel::kOutputTorque, Channel::kInputSpeed, Channel::kGearTemperature, Channel::kVibrationRms}) {
    Readings readings = Quiet();
    readings.output_torque_Nm = readings.input_speed_rad_per_s = readings.gear_temperature_degC = 1e6;
    readings.vibration_rms_m_per_s2 = 1e6;
    std::array<StopReason, 16> all;
    const std::size_t before = kInterlocks.CheckAll(readings, Now(), all);
    readings.bad_channels = BitOf(channel);
    const std::size_t count = kInterlocks.CheckAll(readings, Now(), all);
    const bool guards = channel == Channel::kOutputTorque || channel == Channel::kInputSpeed;
    EXPECT_EQ(count, guards ? before : before - 1) << static_cast<int>(channel);
  }
}

TEST(Interlocks, LetALockedInputTwistWithinItsLimit) {
  InterlockInputs inputs = Now();
  inputs.input_locked = true;
  inputs.twist_rad = RadFromArcmin(29.0);
  EXPECT_FALSE(kInterlocks.Check(Quiet(), inputs));
}

TEST(Interlocks, LowerLimitsAndNeverRaiseThem) {
  Interlocks interlocks(TestLimits(), milliseconds(30));
  schedules::Limits limits = TestLimits();
  limits.output_torque_Nm = 30.0;
  limits.input_speed_rad_per_s = 1e6;
  interlocks.Lower(limits);
  EXPECT_EQ(interlocks.Check(Quiet(), Now()).cause, StopCause::kOutputTorqueLimit);
  limits.output_torque_Nm = 1000.0;
  interlocks.Lower(limits);
  EXPECT_EQ(interlocks.Check(Quiet(), Now()).limit, 30.0);
  Readings fast = Quiet();
  fast.output_torque_Nm = 0.0;
  fast.input_speed_rad_per_s = RadPerSFromRpm(3100.0);
  EXPECT_EQ(interlocks.Check(fast, Now()).cause, StopCause::kInputSpeedLimit);
}

TEST(SuspendMonitor, DoesNotResumeWhileAChannelIsBadAndLowersItsThreshold) {
  schedules::SuspendRule rule;
  rule.trip_temperature_degC = 70.0;
  rule.resume_temperature_degC = 60.0;
  rule.dwell_s = 1.0;
  rule.bad_sensor_s = 2.0;
  SuspendMonitor monitor(rule);
  Readings readings = Quiet();
  readings.bad_channels = BitOf(Channel::kVibrationRms);
  for (int second = 0; second < 10; ++second) EXPECT_FALSE(monitor.Recovered(readings, 1.0));
  monitor.LowerTrip(40.0);
  monitor.LowerTrip(90.0);
  EXPECT_EQ(monitor.Check(Quiet(), 0.01).limit, 40.0);
}

}  // namespace
}  // namespace strainwave::bench::interlocks_test
