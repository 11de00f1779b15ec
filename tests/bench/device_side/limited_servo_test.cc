// SPDX-License-Identifier: Apache-2.0
#include "bench/machines/device_side/limited_servo.h"

#include <gtest/gtest.h>

#include <limits>

#include "bench/machines/device_side/served_load.h"
#include "tests/bench/device_side/noting_servo.h"

namespace strainwave::bench::limited_servo_test {
namespace {

using namespace std::chrono_literals;
constexpr double kNoLimit = std::numeric_limits<double>::infinity();

TEST(LimitedServo, GivesWhatItIsAskedForWithoutALimit) {
  NotingServo servo;
  LimitedServo limited(servo);
  limited.CommandTorque(-40.0);
  EXPECT_EQ(servo.set_point, -40.0);
  limited.CommandSpeed(250.0);
  EXPECT_EQ(servo.set_point, 250.0);
  limited.CommandPosition(1e6);
  EXPECT_EQ(servo.set_point, 1e6);
}

TEST(LimitedServo, GivesNoMoreThanItsLimitsEitherWay) {
  NotingServo servo;
  LimitedServo limited(servo);
  limited.LimitTorque(8.0);
  limited.LimitSpeed(60.0);
  limited.CommandTorque(40.0);
  EXPECT_EQ(servo.set_point, 8.0);
  limited.CommandTorque(-40.0);
  EXPECT_EQ(servo.set_point, -8.0);
  limited.CommandTorque(5.0);
  EXPECT_EQ(servo.set_point, 5.0);
  limited.CommandSpeed(-250.0);
  EXPECT_EQ(servo.set_point, -60.0);
  limited.LimitTorque(kNoLimit);
  limited.CommandTorque(40.0);
  EXPECT_EQ(servo.set_point, 40.0);
}

TEST(LimitedServo, MovesToAPositionNoFasterThanItsLimit) {
  NotingServo servo;
  LimitedServo limited(servo);
  servo.actual.position_rad = 5.0;
  servo.actual.time = 1s;
  limited.LimitSpeed(10.0);
  limited.Enable(DriveMode::kPosition);
  servo.actual.time = 1100ms;
  limited.CommandPosition(7.0);
  EXPECT_NEAR(servo.set_point, 6.0, 1e-9);
  servo.actual.time = 1150ms;
  limited.CommandPosition(7.0);
  EXPECT_NEAR(servo.set_point, 6.5, 1e-9);
  servo.actual.time = 1300ms;
  limited.CommandPosition(7.0);
  EXPECT_NEAR(servo.set_point, 7.0, 1e-9);
}

TEST(LimitedServo, PassesStopsOnAsTheyAre) {
  NotingServo servo;
  LimitedServo limited(servo);
  limited.Enable(DriveMode::kTorque);
  limited.SetBrake(false);
  limited.QuickStop();
  limited.ResetFault();
  limited.Disable();
  EXPECT_EQ(servo.TakeNotes(),
            (std::vector<std::string_view>{"enable torque", "brake off", "quick stop", "reset", "disable"}));
}

// Both enabled with their brakes off, at 250 rad/s under 40 Nm.
struct UnderLoad {
  UnderLoad() {
    for (NotingServo* servo : {&driving_servo, &load_servo}) {
      servo->actual.power = protocols::PowerState::kOperationEnabled;
      servo->actual.brake_engaged = false;
    }
    driving.CommandSpeed(250.0);
    load.CommandTorque(-40.0);
    driving_servo.actual.speed_rad_per_s = 250.0;
    load_servo.actual.torque_Nm = -40.0;
  }
  // Of the next seconds.
  double ServedIn(int seconds) {
    const double before_s = served.served_s();
    for (int step = 0; step < 1000 * seconds; ++step) served.Step(driving, load, 1e-3);
    return served.served_s() - before_s;
  }

  NotingServo driving_servo;
  NotingServo load_servo;
  LimitedServo driving{driving_servo};
  LimitedServo load{load_servo};
  ServedLoad served;
};

TEST(ServedLoad, CountsWhileBothGiveWhatTheyAreAskedFor) {
  UnderLoad bench;
  EXPECT_NEAR(bench.ServedIn(3), 3.0, 1e-6);
}

TEST(ServedLoad, CountsNothingElse) {
  constexpr double kSettles_s = 0.5;
  {
    UnderLoad bench;
    bench.load_servo.actual.torque_Nm = -8.0;
    EXPECT_NEAR(bench.ServedIn(3), kSettles_s, 0.01);
  }
  {
    UnderLoad bench;
    bench.driving_servo.actual.speed_rad_per_s = 60.0;
    EXPECT_NEAR(bench.ServedIn(3), kSettles_s, 0.01);
  }
  {
    UnderLoad bench;
    (void)bench.ServedIn(1);
    bench.load.CommandTorque(0.0);
    EXPECT_NEAR(bench.ServedIn(3), kSettles_s, 0.01);
  }
  {
    UnderLoad bench;
    bench.load_servo.actual.power = protocols::PowerState::kSwitchOnDisabled;
    EXPECT_EQ(bench.ServedIn(3), 0.0);
  }
  {
    UnderLoad bench;
    bench.driving_servo.actual.brake_engaged = true;
    EXPECT_EQ(bench.ServedIn(3), 0.0);
  }
}

}  // namespace
}  // namespace strainwave::bench::limited_servo_test
