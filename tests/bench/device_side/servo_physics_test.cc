// SPDX-License-Identifier: Apache-2.0
#include "bench/machines/device_side/servo_physics.h"

#include <gtest/gtest.h>

#include <functional>
#include <numbers>
#include <stdexcept>
#include <string>

#include "tests/bench/device_side/noting_servo.h"

namespace strainwave::bench::servo_physics_test {
namespace {

using protocols::PowerState;
using protocols::canopen::EdsFile;
using protocols::canopen::device::DriveCommand;
using protocols::canopen::device::DriveLoop;

// 1000 increments a turn, 2 Nm rated; counts against the bench.
constexpr ServoUnits kUnits{1000.0, 2.0, -1};

TEST(ServoPhysics, ConvertsWhatItReads) {
  NotingServo servo;
  ServoPhysics physics(servo, kUnits);
  servo.actual.position_rad = std::numbers::pi;
  servo.actual.speed_rad_per_s = -4 * std::numbers::pi;
  servo.actual.torque_Nm = 0.5;
  const auto reading = physics.Read();
  EXPECT_DOUBLE_EQ(reading.position_inc, -500.0);
  EXPECT_DOUBLE_EQ(reading.speed_inc_per_s, 2000.0);
  EXPECT_DOUBLE_EQ(reading.torque_permille, -250.0);
  EXPECT_FALSE(reading.out_of_order);
  EXPECT_FALSE(reading.safe_torque_off);
  servo.actual.power = PowerState::kFault;
  EXPECT_TRUE(physics.Read().out_of_order);
  physics.OpenSafeTorqueOff(true);
  EXPECT_TRUE(physics.Read().safe_torque_off);
}

TEST(ServoPhysics, ConvertsWhatItCommands) {
  NotingServo servo;
  ServoPhysics physics(servo, kUnits);
  DriveCommand command;
  command.brake_engaged = false;
  command.torque_limit_permille = 800.0;
  command.loop = DriveLoop::kSpeed;
  command.speed_inc_per_s = 500.0;
  physics.Command(command);
  EXPECT_DOUBLE_EQ(servo.set_point, -std::numbers::pi);
  command.loop = DriveLoop::kPosition;
  command.position_inc = 250.0;
  physics.Command(command);
  EXPECT_DOUBLE_EQ(servo.set_point, -0.5 * std::numbers::pi);
  command.loop = DriveLoop::kTorque;
  command.torque_permille = 1000.0;
  physics.Command(command);
  EXPECT_DOUBLE_EQ(servo.set_point, -1.6) << "the limit of 6072h";
}

TEST(ServoPhysics, EnablesOnceAndTakesTheTorqueOffBeforeItBrakes) {
  NotingServo servo;
  ServoPhysics physics(servo, kUnits);
  physics.Command({});
  EXPECT_EQ(servo.TakeNotes(), Notes{});
  DriveCommand command;
  command.loop = DriveLoop::kSpeed;
  command.brake_engaged = false;
  physics.Command(command);
  physics.Command(command);
  EXPECT_EQ(servo.TakeNotes(), (Notes{"enable speed", "brake off"}));
  command.loop = DriveLoop::kTorque;
  physics.Command(command);
  EXPECT_EQ(servo.TakeNotes(), Notes{"enable torque"});
  physics.Command({});
  EXPECT_EQ(servo.TakeNotes(), (Notes{"disable", "brake on"}));
  physics.ResetFault();
  EXPECT_EQ(servo.TakeNotes(), Notes{"reset"});
}

std::string MessageOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "none";
}

std::string MessageOf(const ServoUnits& units) {
  NotingServo servo;
  return MessageOf([&] { ServoPhysics physics(servo, units); });
}

TEST(ServoPhysics, RefusesUnitsThatAreNone) {
  EXPECT_EQ(MessageOf({0.0, 1.0, 1}), "increments_per_turn = 0 (must be finite and above zero)");
  EXPECT_EQ(MessageOf({1.0, -1.0, 1}), "rated_torque_Nm = -1 (must be finite and above zero)");
  EXPECT_EQ(MessageOf({1.0, 1.0, 0}), "sign = 0 (must be 1 or -1)");
}

TEST(UnitsOf, TakesThemFromTheDataSheet) {
  EdsFile eds;
  const auto number = [&](std::uint16_t index, std::uint8_t sub, const char* value) {
    eds.objects[{index, sub}].default_value = std::string(value);
  };
  number(0x608F, 1, "0x10000");
  number(0x608F, 2, "2");
  number(0x6076, 0, "2390");
  const ServoUnits units = UnitsOf(eds, 1);
  EXPECT_EQ(units.increments_per_turn, 32768.0);
  EXPECT_EQ(units.rated_torque_Nm, 2.39);
  number(0x6076, 0, "0");
  EXPECT_EQ(MessageOf([&] { UnitsOf(eds, 1); }),
            "the EDS file gives no default of object 6076:00 (must be above zero)");
}

}  // namespace
}  // namespace strainwave::bench::servo_physics_test
