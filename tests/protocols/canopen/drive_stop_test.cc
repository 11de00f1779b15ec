// SPDX-License-Identifier: Apache-2.0
// Stops, what they forbid, and the way back.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/protocols/canopen/scripted_drive.h"

namespace strainwave::protocols::canopen::drive_stop_test {
namespace {

using namespace std::chrono_literals;
using Texts = std::vector<std::string>;
using enum OperationMode;

// Point 13.
TEST(QuickStop, LowersBitTwoAtOnceWithoutWaitingForSync) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp(kProfileVelocity));
  bench.master.CommandSpeed(100.0);
  bench.Cycle();
  bench.Forget();
  bench.master.QuickStop(bench.now);
  bench.Deliver();
  EXPECT_EQ(bench.SentTo("203"), Texts{"020003"});
  EXPECT_EQ(bench.drive.power, PowerState::kQuickStopActive);
  EXPECT_EQ(bench.drive.target_velocity, 0);
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kQuickStopAsked);
}

// docs/requirements.md R16: yarp-devices#246.
TEST(QuickStop, DropsWhatIsQueuedBothHereAndOnTheBus) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp(kProfileVelocity));
  EXPECT_FALSE(bench.master.TakePurge());
  bench.master.CommandSpeed(100.0);
  bench.now += 4ms;
  bench.master.OnSync(bench.now);  // set-points wait to be taken out
  bench.Forget();
  bench.master.QuickStop(bench.now);
  EXPECT_TRUE(bench.master.TakePurge());
  EXPECT_FALSE(bench.master.TakePurge());
  bench.Deliver();
  EXPECT_EQ(bench.SentTo("203"), Texts{"020003"});
  EXPECT_EQ(bench.SentTo("303"), Texts{"0000000000000000"});
}

TEST(QuickStop, StaysStoppedUntilAResetAndANewEnable) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp(kProfileVelocity));
  bench.master.CommandSpeed(100.0);
  bench.Cycle();
  bench.master.QuickStop(bench.now);
  EXPECT_EQ(bench.master.Enable(kProfileVelocity, bench.now), DriveAnswer::kStillStopping);
  ASSERT_TRUE(bench.CycleUntil(DriveStage::kStopped));
  bench.Forget();
  EXPECT_EQ(bench.master.CommandSpeed(100.0), DriveAnswer::kNotEnabledInMode);
  EXPECT_EQ(bench.master.Enable(kProfileVelocity, bench.now), DriveAnswer::kResetFirst);
  EXPECT_EQ(bench.master.SetBrake(false), DriveAnswer::kResetFirst);
  for (int i = 0; i < 100; ++i) bench.Cycle();
  for (const std::string& payload : bench.SentTo("203")) EXPECT_EQ(payload, "000003");

  EXPECT_EQ(bench.master.ResetFault(bench.now), DriveAnswer::kAccepted);
  for (int i = 0; i < 100; ++i) bench.Cycle();
  EXPECT_EQ(bench.master.stage(), DriveStage::kDisabled);  // a reset alone moves nothing
  EXPECT_EQ(bench.drive.power, PowerState::kSwitchOnDisabled);
  EXPECT_EQ(bench.master.Enable(kProfileVelocity, bench.now), DriveAnswer::kAccepted);
  ASSERT_TRUE(bench.CycleUntil(DriveStage::kEnabled));
  bench.Cycle();
  EXPECT_EQ(bench.drive.target_velocity, 0);  // the speed of before is forgotten
}

// Some option codes leave a drive in quick stop active, with torque on.
TEST(QuickStop, CutsTheVoltageOnceTheShaftStands) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp(kProfileVelocity));
  bench.drive.velocity = 1000;
  bench.Cycle();
  bench.master.QuickStop(bench.now);
  for (int i = 0; i < 10; ++i) bench.Cycle();
  EXPECT_EQ(bench.master.stage(), DriveStage::kStopping);
  EXPECT_EQ(bench.drive.controlword, 0x0002);
  bench.drive.velocity = 0;
  bench.Cycle();
  EXPECT_EQ(bench.master.stage(), DriveStage::kStopped);
  EXPECT_EQ(bench.drive.controlword, 0x0000);
}

TEST(QuickStop, CutsTheVoltageAnywayWhenTheTimeIsUpAndSaysIfTheDriveStaysEnabled) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp(kProfileVelocity));
  bench.drive.takes_commands = false;
  bench.master.QuickStop(bench.now);
  const auto begin = bench.now;
  ASSERT_TRUE(bench.CycleUntil(DriveStage::kStopped));
  EXPECT_EQ(bench.now - begin, 2s);
  bench.Cycle();
  EXPECT_EQ(bench.drive.controlword, 0x0000);
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kQuickStopAsked);
  EXPECT_EQ(bench.master.last_trouble(), DriveTrouble::kStaysEnabled);
}

TEST(Disable, SaysThatTheDriveStaysEnabled) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp(kProfileVelocity));
  bench.drive.takes_commands = false;
  bench.master.Disable(bench.now);
  for (int i = 0; i < 199; ++i) bench.Cycle();
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kNone);
  bench.Cycle();
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kStaysEnabled);
}

// Point 4: canopen#167.
TEST(StoppedByDrive, IsSeenInOneFrameBetweenTwoCycles) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp(kProfileVelocity));
  bench.master.CommandSpeed(100.0);
  bench.Cycle();
  bench.Hear("183#1702030000");  // quick stop active
  bench.Hear("183#3702030000");  // and operation enabled again before anyone looked
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kStoppedByDrive);
  EXPECT_EQ(bench.master.TroubleWords(),
            "node 3: the drive stopped by itself: safe torque off, limit switch or enable input (quick stop "
            "active)");
  bench.Deliver();
  EXPECT_EQ(bench.drive.power, PowerState::kQuickStopActive);
}

TEST(StoppedByDrive, IsEveryStateButOperationEnabled) {
  for (const PowerState power :
       {PowerState::kNotReadyToSwitchOn, PowerState::kSwitchOnDisabled, PowerState::kReadyToSwitchOn,
        PowerState::kSwitchedOn, PowerState::kQuickStopActive}) {
    DriveBench bench;
    ASSERT_TRUE(bench.BringUp(kProfileVelocity));
    bench.drive.power = power;
    bench.Cycle();
    EXPECT_EQ(bench.master.trouble(), DriveTrouble::kStoppedByDrive) << Name(power);
    ASSERT_TRUE(bench.CycleUntil(DriveStage::kStopped));
    EXPECT_EQ(bench.master.Enable(kProfileVelocity, bench.now), DriveAnswer::kResetFirst);
  }
}

// Point 5.
TEST(FaultReset, IsAnEdgeThatIsToggledEachTime) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp(kProfileVelocity));
  bench.drive.power = PowerState::kFault;
  bench.drive.error_code = 0x2310;
  bench.Cycle();
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kFault);
  EXPECT_EQ(bench.master.TroubleWords(),
            "node 3: the drive is in fault: 2310h, continuous over-current on the motor side");
  ASSERT_TRUE(bench.CycleUntil(DriveStage::kStopped));
  for (int round = 0; round < 3; ++round) {
    bench.drive.power = PowerState::kFault;
    bench.drive.takes_commands = round == 2;  // twice in vain
    bench.Forget();
    EXPECT_EQ(bench.master.ResetFault(bench.now), DriveAnswer::kAccepted);
    for (int i = 0; i < 300 && bench.master.stage() == DriveStage::kResetting; ++i) bench.Cycle();
    Texts levels;
    for (const std::string& payload : bench.SentTo("203")) {
      if (levels.empty() || levels.back() != payload.substr(0, 4)) levels.push_back(payload.substr(0, 4));
    }
    if (round < 2) {
      EXPECT_EQ(levels, (Texts{"0000", "8000", "0000", "0200"}));
      EXPECT_EQ(bench.master.trouble(), DriveTrouble::kFaultNotReset);
      ASSERT_TRUE(bench.CycleUntil(DriveStage::kStopped));
    } else {
      EXPECT_EQ(levels, (Texts{"0000", "8000", "0000"}));
      EXPECT_EQ(bench.master.stage(), DriveStage::kDisabled);
      EXPECT_EQ(bench.master.trouble(), DriveTrouble::kNone);
    }
  }
}

TEST(FaultReset, HoldsEachLevelForAStatedTime) {
  DriveProfile profile = EasyProfile();
  profile.timing.reset_hold = 40ms;
  DriveBench bench(profile);
  ASSERT_TRUE(bench.BringUp());
  bench.drive.power = PowerState::kFault;
  ASSERT_TRUE(bench.CycleUntil(DriveStage::kStopped));
  bench.Forget();
  bench.master.ResetFault(bench.now);
  ASSERT_TRUE(bench.CycleUntil(DriveStage::kDisabled));
  const Texts sent = bench.SentTo("203");
  EXPECT_EQ(std::count(sent.begin(), sent.end(), "800003"), 10);
}

TEST(FaultReset, WaitsForTheFaultReactionToEnd) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp(kProfileVelocity));
  bench.drive.takes_commands = false;
  bench.drive.power = PowerState::kFaultReactionActive;
  bench.Cycle();
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kFault);
  EXPECT_EQ(bench.master.ResetFault(bench.now), DriveAnswer::kStillStopping);
}

// Point 14.
TEST(Brake, IsReleasedByItsBitAndEngagedByEveryStop) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp(kProfileVelocity));
  EXPECT_EQ(bench.drive.digital_outputs, 0U);  // engaged, until somebody releases it
  EXPECT_TRUE(bench.master.status().is_brake_engaged);
  EXPECT_EQ(bench.master.SetBrake(false), DriveAnswer::kAccepted);
  bench.Cycle();
  EXPECT_EQ(bench.drive.digital_outputs, 1U);
  EXPECT_FALSE(bench.master.status().is_brake_engaged);
  bench.master.Disable(bench.now);
  bench.Deliver();
  EXPECT_EQ(bench.drive.digital_outputs, 1U);  // not touched
  bench.master.QuickStop(bench.now);
  EXPECT_TRUE(bench.master.status().is_brake_engaged);
  bench.Deliver();
  EXPECT_EQ(bench.drive.digital_outputs, 0U);
}

TEST(Brake, WaitsForStandstillWhereTheProfileSaysSo) {
  DriveProfile profile = EasyProfile();
  profile.brake.waits_for_standstill = true;
  DriveBench bench(profile);
  ASSERT_TRUE(bench.BringUp(kProfileVelocity));
  bench.master.SetBrake(false);
  bench.drive.velocity = 1000;
  bench.Cycle();
  bench.master.QuickStop(bench.now);
  for (int i = 0; i < 10; ++i) bench.Cycle();
  EXPECT_EQ(bench.drive.digital_outputs, 1U);
  bench.drive.velocity = 0;
  bench.Cycle();
  EXPECT_EQ(bench.drive.digital_outputs, 0U);
}

TEST(Brake, MayBeABitOfTheControlwordWithEitherSense) {
  DriveProfile profile = EasyProfile();
  profile.brake = {.by = BrakeControl::By::kControlword, .mask = 0x4000, .engages_when_high = true};
  DriveBench bench(profile);
  ASSERT_TRUE(bench.BringUp());
  bench.Forget();
  bench.Cycle();
  EXPECT_EQ(bench.SentTo("203"), Texts{"004003"});
  bench.master.SetBrake(false);
  bench.Forget();
  bench.Cycle();
  EXPECT_EQ(bench.SentTo("203"), Texts{"000003"});
}

TEST(Brake, IsShownFromItsFeedback) {
  DriveProfile profile = EasyProfile();
  profile.brake.engaged_feedback = {BitSource::From::kStatusword, 0x4000, false};
  DriveBench bench(profile);
  ASSERT_TRUE(bench.BringUp());
  EXPECT_FALSE(bench.master.status().is_brake_engaged);
  bench.drive.mode_bits = 0x4200;
  bench.Cycle();
  EXPECT_TRUE(bench.master.status().is_brake_engaged);
}

// Closed as long as the bit is there.
DriveBench WithSafeTorqueOff() {
  DriveProfile profile = EasyProfile();
  profile.safe_torque_off = {BitSource::From::kStatusword, 0x8000, true};
  DriveBench bench(profile);
  bench.drive.mode_bits = 0x8200;
  return bench;
}

TEST(SafeTorqueOff, IsShownFromItsBit) {
  DriveBench bench = WithSafeTorqueOff();
  ASSERT_TRUE(bench.BringUp());
  EXPECT_EQ(bench.master.status().is_torque_safely_off, false);
  bench.drive.mode_bits = 0x0200;
  bench.Cycle();
  EXPECT_EQ(bench.master.status().is_torque_safely_off, true);

  DriveBench plain;
  ASSERT_TRUE(plain.BringUp());
  EXPECT_EQ(plain.master.status().is_torque_safely_off, std::nullopt);
}

TEST(SafeTorqueOff, IsATroubleWhetherTheDriveIsEnabledOrNot) {
  for (const bool is_enabled : {false, true}) {
    DriveBench bench = WithSafeTorqueOff();
    ASSERT_TRUE(is_enabled ? bench.BringUp(kProfileVelocity) : bench.BringUp());
    EXPECT_EQ(bench.master.trouble(), DriveTrouble::kNone);
    bench.drive.mode_bits = 0x0200;
    bench.Cycle();
    bench.Cycle();
    EXPECT_EQ(bench.master.trouble(), DriveTrouble::kSafeTorqueOff) << is_enabled;
  }
}

TEST(SafeTorqueOff, IsNamedBehindWhatTheDriveMakesOfIt) {
  DriveBench bench = WithSafeTorqueOff();
  ASSERT_TRUE(bench.BringUp(kProfileVelocity));
  bench.Hear("083#4054010000000000");
  ASSERT_TRUE(bench.CycleUntil(DriveStage::kStopped));
  EXPECT_EQ(bench.master.last_trouble(), DriveTrouble::kEmergency);
  bench.drive.mode_bits = 0x0200;
  bench.Cycle();
  bench.Cycle();
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kEmergency);
  EXPECT_EQ(bench.master.last_trouble(), DriveTrouble::kSafeTorqueOff);
}

TEST(SafeTorqueOff, MayBeOpenAfterAStopThatWasAskedFor) {
  DriveBench bench = WithSafeTorqueOff();
  ASSERT_TRUE(bench.BringUp(kProfileVelocity));
  bench.master.QuickStop(bench.now);
  ASSERT_TRUE(bench.CycleUntil(DriveStage::kStopped));
  bench.drive.mode_bits = 0x0200;
  for (int i = 0; i < 10; ++i) bench.Cycle();
  EXPECT_EQ(bench.master.last_trouble(), DriveTrouble::kQuickStopAsked);
}

TEST(SafeTorqueOff, IsResetOnlyOnceItIsClosed) {
  DriveBench bench = WithSafeTorqueOff();
  ASSERT_TRUE(bench.BringUp());
  bench.drive.mode_bits = 0x0200;
  ASSERT_TRUE(bench.CycleUntil(DriveStage::kStopped));
  ASSERT_EQ(bench.master.ResetFault(bench.now), DriveAnswer::kAccepted);
  for (int i = 0; i < 100; ++i) bench.Cycle();
  EXPECT_EQ(bench.master.stage(), DriveStage::kStopped);
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kSafeTorqueOff);
  bench.drive.mode_bits = 0x8200;
  bench.Cycle();
  ASSERT_EQ(bench.master.ResetFault(bench.now), DriveAnswer::kAccepted);
  EXPECT_TRUE(bench.CycleUntil(DriveStage::kDisabled));
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kNone);
}

}  // namespace
}  // namespace strainwave::protocols::canopen::drive_stop_test
