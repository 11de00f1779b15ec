// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/simulated/simulated_drive.h"

#include <gtest/gtest.h>

namespace strainwave::bench::simulated_drive_test {
namespace {

using protocols::PowerState;

void Steps(SimulatedDrive& drive, int count) {
  for (int i = 0; i < count; ++i) drive.StepPowerState();
}

TEST(SimulatedDrive, StartsDisabledWithItsBrakeOn) {
  const SimulatedDrive drive(true);
  EXPECT_EQ(drive.Actual().power, PowerState::kSwitchOnDisabled);
  EXPECT_TRUE(drive.Actual().brake_engaged);
}

TEST(SimulatedDrive, WalksToOperationEnabledOneTransitionAStep) {
  SimulatedDrive drive(true);
  drive.Enable(DriveMode::kSpeed);
  EXPECT_EQ(drive.Actual().power, PowerState::kSwitchOnDisabled);
  Steps(drive, 1);
  EXPECT_EQ(drive.Actual().power, PowerState::kReadyToSwitchOn);
  Steps(drive, 1);
  EXPECT_EQ(drive.Actual().power, PowerState::kSwitchedOn);
  Steps(drive, 1);
  EXPECT_EQ(drive.Actual().power, PowerState::kOperationEnabled);
}

TEST(SimulatedDrive, IgnoresSetPointsUntilEnabledAndOfOtherModes) {
  SimulatedDrive drive(true);
  drive.Enable(DriveMode::kSpeed);
  drive.CommandSpeed(50.0);
  Steps(drive, 3);
  EXPECT_EQ(drive.set_point(), 0.0);
  drive.CommandTorque(1.0);
  EXPECT_EQ(drive.set_point(), 0.0);
  drive.CommandSpeed(50.0);
  EXPECT_EQ(drive.set_point(), 50.0);
}

TEST(SimulatedDrive, StartsAPositionWhereTheShaftIs) {
  SimulatedDrive drive(true);
  drive.Report(std::chrono::nanoseconds{}, 12.5, 0.0, 0.0);
  drive.Enable(DriveMode::kPosition);
  Steps(drive, 3);
  EXPECT_EQ(drive.set_point(), 12.5);
}

TEST(SimulatedDrive, TakesTorqueOffAndPutsTheBrakeOnAtOnceInAQuickStop) {
  SimulatedDrive drive(true);
  drive.Enable(DriveMode::kSpeed);
  Steps(drive, 3);
  drive.SetBrake(false);
  drive.CommandSpeed(100.0);
  drive.QuickStop();
  EXPECT_FALSE(drive.enabled());
  EXPECT_TRUE(drive.Actual().brake_engaged);
  EXPECT_EQ(drive.set_point(), 0.0);
  Steps(drive, 5);
  EXPECT_EQ(drive.Actual().power, PowerState::kSwitchOnDisabled);
}

TEST(SimulatedDrive, LeavesTheBrakeAloneWhenDisabled) {
  SimulatedDrive drive(true);
  drive.Enable(DriveMode::kSpeed);
  Steps(drive, 3);
  drive.SetBrake(false);
  drive.Disable();
  EXPECT_FALSE(drive.enabled());
  EXPECT_FALSE(drive.Actual().brake_engaged);
}

TEST(SimulatedDrive, StaysInFaultUntilItIsReset) {
  SimulatedDrive drive(true);
  drive.Enable(DriveMode::kSpeed);
  Steps(drive, 3);
  drive.Fault();
  EXPECT_EQ(drive.Actual().power, PowerState::kFaultReactionActive);
  Steps(drive, 1);
  EXPECT_EQ(drive.Actual().power, PowerState::kFault);
  drive.Enable(DriveMode::kSpeed);
  Steps(drive, 5);
  EXPECT_EQ(drive.Actual().power, PowerState::kFault);
  drive.ResetFault();
  Steps(drive, 5);
  EXPECT_EQ(drive.Actual().power, PowerState::kSwitchOnDisabled);  // a reset starts nothing
}

TEST(SimulatedDrive, KeepsADriveWithoutPositionModeOutOfIt) {
  SimulatedDrive drive(false);
  drive.Enable(DriveMode::kPosition);
  Steps(drive, 5);
  EXPECT_FALSE(drive.enabled());
  drive.Enable(DriveMode::kTorque);
  Steps(drive, 3);
  EXPECT_TRUE(drive.enabled());
}

}  // namespace
}  // namespace strainwave::bench::simulated_drive_test
