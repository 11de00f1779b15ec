// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "bench/configuration/embedded_bench.h"
#include "bench/safety/interlocks.h"
#include "bench/trip_test/metal_trips.h"

namespace strainwave::bench::metal_way_test {
namespace {

using Kind = MetalWay::Kind;

TripRow RowOf(StopCause cause) {
  TripRow row;
  row.cause = cause;
  return row;
}

ProvokedState Turning() {
  ProvokedState state;
  state.readings.output_torque_Nm = -8.0;
  state.readings.input_speed_rad_per_s = 31.0;
  state.readings.gear_temperature_degC = -3.0;  // a bench in the cold
  state.readings.vibration_rms_m_per_s2 = 0.4;
  state.twist_rad = -1e-3;
  return state;
}

TEST(LoweredFor, BringsOneLimitBelowWhatIsReadAndLeavesTheOthers) {
  const ProvokedState state = Turning();
  EXPECT_NEAR(LoweredFor(RowOf(StopCause::kOutputTorqueLimit), state).limits.output_torque_Nm, 4.0, 1e-12);
  EXPECT_NEAR(LoweredFor(RowOf(StopCause::kInputSpeedLimit), state).limits.input_speed_rad_per_s, 15.5,
              1e-12);
  EXPECT_NEAR(LoweredFor(RowOf(StopCause::kGearTemperatureLimit), state).limits.gear_temperature_degC, -4.0,
              1e-12);
  EXPECT_NEAR(LoweredFor(RowOf(StopCause::kVibrationLimit), state).limits.vibration_rms_m_per_s2, 0.2, 1e-12);
  const LoweredLimits twist = LoweredFor(RowOf(StopCause::kTwistLimit), state);
  EXPECT_NEAR(twist.limits.twist_rad, 5e-4, 1e-15);
  EXPECT_TRUE(std::isinf(twist.limits.output_torque_Nm));
  EXPECT_TRUE(std::isinf(twist.trip_temperature_degC));
  EXPECT_NEAR(LoweredFor(RowOf(StopCause::kTemperatureSuspend), state).trip_temperature_degC, -4.0, 1e-12);
}

TEST(Lower, NeverRaisesALimit) {
  schedules::Limits limits{60.0, 300.0, 75.0, 50.0, 1e-2};
  Interlocks interlocks(limits, std::chrono::milliseconds(30));
  Readings readings;
  readings.output_torque_Nm = 61.0;
  constexpr double kNever = std::numeric_limits<double>::infinity();
  interlocks.Lower({100.0, kNever, 74.0, kNever, kNever});
  EXPECT_EQ(interlocks.Check(readings, {}).cause, StopCause::kOutputTorqueLimit);
  readings.output_torque_Nm = 0.0;
  readings.gear_temperature_degC = 74.5;
  EXPECT_EQ(interlocks.Check(readings, {}).cause, StopCause::kGearTemperatureLimit);

  schedules::SuspendRule rule;
  rule.trip_temperature_degC = 70.0;
  SuspendMonitor monitor(rule);
  monitor.LowerTrip(80.0);
  EXPECT_EQ(monitor.Check(readings, 0.01).cause, StopCause::kTemperatureSuspend);
}

TEST(WayOnMetal, AsksForWhatAHandCanDoAndForNothingDangerous) {
  const BenchDescription bench = EmbeddedBench();
  TripRow torque = RowOf(StopCause::kImplausibleReading);
  torque.channel = Channel::kOutputTorque;
  EXPECT_EQ(WayOnMetal(torque, bench).words, "pull the cable of the torque transducer SIM-TORQUE");
  TripRow speed = torque;
  speed.channel = Channel::kInputSpeed;
  EXPECT_EQ(WayOnMetal(speed, bench).words, "it has no cable of its own: the drive tells it");
  EXPECT_EQ(WayOnMetal(speed, bench).kind, Kind::kNot);
  TripRow silent = RowOf(StopCause::kDriveSilent);
  silent.servo = BenchServo::kLoad;
  EXPECT_EQ(WayOnMetal(silent, bench).words, "pull the bus cable of the load servo");
  for (const StopCause cause : {StopCause::kBrakeEngaged, StopCause::kTorqueAway, StopCause::kSpeedAway,
                                StopCause::kDriveNotReady, StopCause::kInputAngleApart}) {
    EXPECT_EQ(WayOnMetal(RowOf(cause), bench).kind, Kind::kNot) << Code(cause);
  }
  for (const StopCause cause :
       {StopCause::kOutputTorqueLimit, StopCause::kInputSpeedLimit, StopCause::kGearTemperatureLimit,
        StopCause::kVibrationLimit, StopCause::kTwistLimit, StopCause::kTemperatureSuspend}) {
    EXPECT_EQ(WayOnMetal(RowOf(cause), bench).kind, Kind::kLowered) << Code(cause);
  }
}

}  // namespace
}  // namespace strainwave::bench::metal_way_test
