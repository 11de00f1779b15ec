// SPDX-License-Identifier: Apache-2.0
// The inside of the device side's drive on Modbus, with a motor.
#include "bench/machines/device_side/modbus_servo_model.h"

#include <gtest/gtest.h>

#include "bench/configuration/read_register_map.h"
#include "tests/bench/device_side/noting_servo.h"
#include "tests/checkout.h"

namespace strainwave::bench::modbus_servo_model_test {
namespace {

using namespace std::chrono_literals;
using protocols::PowerState;
using Notes = std::vector<std::string_view>;

class ModelWithMotor : public testing::Test {
 protected:
  void Write(const char* name, double value) {
    ASSERT_TRUE(model_.Write(*protocols::modbus::Find(profile_.map, name), value, now_));
  }
  double Read(const char* name) { return model_.Read(*protocols::modbus::Find(profile_.map, name), now_); }
  void Turn() { model_.Turn(motor_, kReducer, now_); }
  // With 0.5 Nm at the motor's shaft.
  void PullTorque() {
    Write("mode", 2);
    Write("torque_set_point", 0.5);
    Write("brake", 1);
    Write("control", 1);
    Turn();
    motor_.actual.power = PowerState::kOperationEnabled;
    Turn();
  }

  static constexpr double kReducer = 70.0;
  ModbusProfile profile_ = ReadModbusProfile(SourceFolder() + "/tests/simulation/field/modbus_drive.yaml");
  ModbusServoModel model_{profile_.map, *profile_.servo};
  NotingServo motor_;
  std::chrono::nanoseconds now_{1s};
};

TEST_F(ModelWithMotor, CommandsTheShaftBehindTheReducer) {
  PullTorque();
  EXPECT_EQ(motor_.TakeNotes(), (Notes{"enable torque", "brake off"}));
  EXPECT_DOUBLE_EQ(motor_.set_point, 35.0);
  Write("mode", 1);
  Write("speed_set_point", 140.0);
  Turn();
  EXPECT_EQ(motor_.TakeNotes(), Notes{"enable speed"});
  EXPECT_DOUBLE_EQ(motor_.set_point, 2.0);
}

TEST_F(ModelWithMotor, TellsWhatTheMotorReallyDoes) {
  PullTorque();
  motor_.actual.torque_Nm = 7.0;
  motor_.actual.speed_rad_per_s = -0.5;
  motor_.actual.position_rad = 0.25;
  Turn();
  EXPECT_DOUBLE_EQ(Read("actual_torque"), 0.1);
  EXPECT_DOUBLE_EQ(Read("actual_speed"), -35.0);
  EXPECT_DOUBLE_EQ(Read("actual_position"), 17.5);
  EXPECT_EQ(Read("status"), 2);
  motor_.actual.power = PowerState::kSwitchedOn;  // on its way
  Turn();
  EXPECT_EQ(Read("status"), 1);
}

TEST_F(ModelWithMotor, ItsPositionGoesOverAtTheEndsOfItsRegister) {
  const double step_rad =
      profile_.map.registers[*protocols::modbus::Find(profile_.map, "actual_position")].scale;
  motor_.actual.position_rad = 3.0e9 * step_rad / kReducer;
  Turn();
  EXPECT_NEAR(Read("actual_position") / step_rad, 3.0e9 - 4294967296.0, 1e-3);
}

TEST_F(ModelWithMotor, IsOffAfterEverythingThatEndsIt) {
  for (const char* const way : {"off", "quick stop", "watchdog", "input", "restart", "fault"}) {
    SCOPED_TRACE(way);
    const std::string_view what = way;
    Write("control", 4);
    Write("control", 0);
    Write("watchdog_time", 0.8);
    PullTorque();
    (void)motor_.TakeNotes();
    if (what == "off") Write("control", 0);
    if (what == "quick stop") Write("control", 2);
    if (what == "watchdog") now_ += 801ms;
    if (what == "input") model_.set_faults({.enable_input_open = true});
    if (what == "restart") model_.Restart();
    if (what == "fault") model_.Fault();
    Turn();
    const Notes notes = motor_.TakeNotes();
    ASSERT_FALSE(notes.empty());
    EXPECT_EQ(notes.front(), "disable") << "the torque before anything else";
    EXPECT_NE(model_.power(now_), PowerState::kOperationEnabled);
    EXPECT_EQ(Read("watchdog_time"), what == "restart" ? 0.0 : 0.8);
    if (what == "input") {
      Write("control", 1);
      EXPECT_EQ(Read("status"), 0) << "it cannot be enabled";
      model_.set_faults({});
    }
  }
}

TEST_F(ModelWithMotor, TellsWhatItIsToldTo) {
  PullTorque();
  motor_.actual.speed_rad_per_s = 1.0;
  Turn();
  Write("watchdog", 7);
  model_.set_faults({.stuck_status = 15, .count_stuck = true, .brake_inverted = true, .actual_stuck = true});
  motor_.actual.speed_rad_per_s = 2.0;
  Turn();
  Write("watchdog", 8);
  EXPECT_EQ(Read("status"), 15);
  EXPECT_EQ(Read("watchdog"), 7);
  EXPECT_EQ(Read("brake"), 0);
  EXPECT_DOUBLE_EQ(Read("actual_speed"), 70.0);
  model_.set_faults({});
  EXPECT_EQ(Read("status"), 2);
  EXPECT_EQ(Read("watchdog"), 8);
  EXPECT_EQ(Read("brake"), 1);
  EXPECT_DOUBLE_EQ(Read("actual_speed"), 140.0);
}

}  // namespace
}  // namespace strainwave::bench::modbus_servo_model_test
