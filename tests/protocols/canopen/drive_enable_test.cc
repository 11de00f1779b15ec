// SPDX-License-Identifier: Apache-2.0
// From power-on to operation enabled.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "tests/protocols/canopen/scripted_drive.h"

namespace strainwave::protocols::canopen::drive_enable_test {
namespace {

using namespace std::chrono_literals;
using Texts = std::vector<std::string>;
using enum OperationMode;

std::string Controlword(const std::string& payload) { return payload.substr(2, 2) + payload.substr(0, 2); }

// Each controlword once for as long as it stays.
Texts Controlwords(const DriveBench& bench) {
  Texts words;
  for (const std::string& payload : bench.SentTo("203")) {
    if (words.empty() || words.back() != Controlword(payload)) words.push_back(Controlword(payload));
  }
  return words;
}

TEST(DriveMaster, SetsUpInPreOperationalAndThenStartsTheNode) {
  DriveBench bench;
  EXPECT_TRUE(bench.BringUp()) << bench.master.TroubleWords();
  EXPECT_EQ(bench.drive.nmt, (Texts{"000#8003", "000#0103"}));
  EXPECT_EQ(bench.sent[0], "000#8003");
  EXPECT_EQ(bench.master.nmt_state(), NmtState::kOperational);
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kNone);
}

TEST(DriveMaster, SendsNothingByItself) {
  DriveBench bench;
  for (int i = 0; i < 100; ++i) bench.Cycle();
  bench.Hear("703#00");
  bench.Cycle();
  EXPECT_EQ(bench.sent, Texts{});
  EXPECT_EQ(bench.master.stage(), DriveStage::kOff);
}

TEST(DriveMaster, SendsNoProcessDataBeforeTheNodeIsOperational) {
  DriveBench bench;
  bench.master.Commission(bench.now);
  while (bench.master.stage() != DriveStage::kStarting) bench.Cycle();
  EXPECT_EQ(bench.SentTo("203"), Texts{});
  EXPECT_EQ(bench.master.Enable(kProfileVelocity, bench.now), DriveAnswer::kCommissionFirst);
}

TEST(DriveMaster, SaysThatANodeDoesNotStart) {
  DriveBench bench;
  bench.sends_pdos = false;
  bench.master.Commission(bench.now);
  EXPECT_FALSE(bench.CycleUntil(DriveStage::kDisabled));
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kNotOperational);
  EXPECT_EQ(bench.master.stage(), DriveStage::kOff);
}

// docs/requirements.md R15.
TEST(DriveMaster, RefusesEnableWhereCommissioningFailed) {
  DriveProfile profile = EasyProfile();
  profile.supervision.communication_error_behaviour = 1;
  DriveBench bench(profile);
  EXPECT_FALSE(bench.BringUp());
  EXPECT_EQ(bench.master.Enable(kProfileVelocity, bench.now), DriveAnswer::kCommissionFirst);
  EXPECT_EQ(bench.master.TroubleWords(),
            "the drive could not be set up: node 3 must not be enabled, it would not notice that the "
            "master is gone: behaviour when communication fails (1029h:01) reads back as off (01h)");
  for (int i = 0; i < 100; ++i) bench.Cycle();
  EXPECT_EQ(bench.SentTo("203"), Texts{});
}

TEST(DriveMaster, WalksThePowerStatesUpOneByOne) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp());
  bench.Forget();
  EXPECT_EQ(bench.master.Enable(kProfileVelocity, bench.now), DriveAnswer::kAccepted);
  ASSERT_TRUE(bench.CycleUntil(DriveStage::kEnabled)) << bench.master.TroubleWords();
  bench.Cycle();
  EXPECT_EQ(Controlwords(bench), (Texts{"0000", "0006", "0007", "000F"}));
  EXPECT_EQ(bench.drive.power, PowerState::kOperationEnabled);
}

// Point 6.
TEST(DriveMaster, RaisesNoPowerBeforeTheModeIsConfirmedOn6061h) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp());
  bench.drive.confirms_mode = false;
  bench.drive.mode_display = 8;
  bench.Forget();
  bench.master.Enable(kProfileVelocity, bench.now);
  for (int i = 0; i < 50; ++i) bench.Cycle();  // 200 ms
  EXPECT_EQ(bench.master.stage(), DriveStage::kChangingMode);
  EXPECT_EQ(Controlwords(bench), (Texts{"0000"}));
  EXPECT_EQ(bench.SentTo("203").back(), "000003");
  bench.drive.mode_display = 3;  // late, but in time
  ASSERT_TRUE(bench.CycleUntil(DriveStage::kEnabled));
}

TEST(DriveMaster, SaysThatAModeWasNotConfirmed) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp());
  bench.drive.confirms_mode = false;
  bench.drive.mode_display = 8;
  bench.master.Enable(kProfileVelocity, bench.now);
  ASSERT_TRUE(bench.CycleUntil(DriveStage::kStopped));
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kModeNotConfirmed);
  EXPECT_EQ(bench.master.TroubleWords(),
            "node 3: the drive does not confirm the mode of operation: profile velocity was asked for, 6061h "
            "shows 8");
}

TEST(DriveMaster, StopsWhenTheModeChangesUnasked) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp(kProfileVelocity));
  bench.drive.confirms_mode = false;
  bench.drive.mode_display = 1;
  bench.Cycle();
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kModeNotConfirmed);
  EXPECT_EQ(bench.drive.power, PowerState::kQuickStopActive);
}

// Point 6, the other half: a master that never halts has no halt bit in the way of a mode change.
TEST(DriveMaster, NeverSetsTheHaltBit) {
  for (const OperationMode mode : EasyProfile().modes) {
    DriveBench bench;
    ASSERT_TRUE(bench.BringUp(mode)) << Name(mode);
    bench.master.QuickStop(bench.now);
    ASSERT_TRUE(bench.CycleUntil(DriveStage::kStopped));
    for (const std::string& payload : bench.SentTo("203")) {
      EXPECT_EQ(std::stoul(Controlword(payload), nullptr, 16) & 0x0100, 0U);
    }
  }
}

// Point 7.
TEST(DriveMaster, EnablesWithTargetsAtTheActualValuesInEveryMode) {
  for (const OperationMode mode : EasyProfile().modes) {
    DriveBench bench;
    bench.drive.position = -123456;
    bench.drive.velocity = 77;
    bench.drive.torque = 55;
    ASSERT_TRUE(bench.BringUp());
    bench.Forget();
    bench.master.Enable(mode, bench.now);
    for (int i = 0; i < 20; ++i) {
      // The shaft is turned by the other side of the bench meanwhile.
      if (bench.drive.power != PowerState::kOperationEnabled) bench.drive.position += 10;
      bench.Cycle();
      if (bench.master.stage() == DriveStage::kEnabled) break;
      EXPECT_EQ(bench.drive.target_position, bench.drive.position);
      EXPECT_EQ(bench.drive.target_velocity, 0);
      EXPECT_EQ(bench.drive.target_torque, 0);
    }
    ASSERT_EQ(bench.master.stage(), DriveStage::kEnabled);
    for (int i = 0; i < 20; ++i) bench.Cycle();
    EXPECT_EQ(bench.drive.target_position, bench.drive.position);
    EXPECT_EQ(bench.drive.target_velocity, 0);
    EXPECT_EQ(bench.drive.target_torque, 0);
  }
}

TEST(DriveMaster, TakesNoSetPointOnTheWayUp) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp());
  EXPECT_EQ(bench.master.CommandSpeed(10.0), DriveAnswer::kNotEnabledInMode);
  bench.master.Enable(kProfileVelocity, bench.now);
  while (bench.master.stage() != DriveStage::kEnabled) {
    EXPECT_EQ(bench.master.CommandSpeed(10.0), DriveAnswer::kNotEnabledInMode);
    bench.Cycle();
  }
  bench.Cycle();
  EXPECT_EQ(bench.drive.target_velocity, 0);
  EXPECT_EQ(bench.master.CommandSpeed(10.0), DriveAnswer::kAccepted);
}

TEST(DriveMaster, SaysAtWhichStateAnEnableTimedOut) {
  const std::pair<PowerState, std::string> stuck[] = {
      {PowerState::kNotReadyToSwitchOn, "not ready to switch on"},
      {PowerState::kSwitchOnDisabled, "switch on disabled"},
      {PowerState::kReadyToSwitchOn, "ready to switch on"},
      {PowerState::kSwitchedOn, "switched on"},
  };
  for (const auto& [power, name] : stuck) {
    DriveBench bench;
    ASSERT_TRUE(bench.BringUp());
    bench.drive.takes_commands = false;
    bench.drive.power = power;
    bench.master.Enable(kProfileVelocity, bench.now);
    const auto begin = bench.now;
    ASSERT_TRUE(bench.CycleUntil(DriveStage::kStopping)) << name;
    EXPECT_GE(bench.now - begin, 800ms);
    EXPECT_LE(bench.now - begin, 820ms);
    EXPECT_EQ(bench.master.trouble(), DriveTrouble::kEnableTimedOut);
    EXPECT_EQ(bench.master.TroubleWords(),
              "node 3: the drive does not reach operation enabled (" + name + ")");
  }
}

TEST(DriveMaster, IsNotHeldUpForEverByADriveThatClimbsAndFallsBack) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp());
  bench.drive.takes_commands = false;
  bench.master.Enable(kProfileVelocity, bench.now);
  for (int i = 0; i < 300 && bench.master.trouble() == DriveTrouble::kNone; ++i) {
    bench.drive.power = i % 2 == 0 ? PowerState::kReadyToSwitchOn : PowerState::kSwitchOnDisabled;
    bench.Cycle();
  }
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kEnableTimedOut);
}

TEST(DriveMaster, ChangesTheModeOfAnEnabledDriveOnlyAfterItHasComeDown) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp(kProfileVelocity));
  bench.master.CommandSpeed(100.0);
  bench.Cycle();
  bench.Forget();
  EXPECT_EQ(bench.master.Enable(kProfileTorque, bench.now), DriveAnswer::kAccepted);
  ASSERT_TRUE(bench.CycleUntil(DriveStage::kEnabled)) << bench.master.TroubleWords();
  const Texts sent = bench.SentTo("203");
  EXPECT_EQ(sent[0], "070003");  // disable operation, still in the old mode
  EXPECT_EQ(bench.drive.mode_display, 4);
  EXPECT_EQ(bench.drive.target_velocity, 0);
  for (const std::string& payload : sent) EXPECT_NE(payload, "0F0003");
  // Back in the same mode nothing happens.
  bench.Forget();
  EXPECT_EQ(bench.master.Enable(kProfileTorque, bench.now), DriveAnswer::kAccepted);
  EXPECT_EQ(bench.master.stage(), DriveStage::kEnabled);
}

TEST(DriveMaster, RefusesAModeThatIsNotInTheProfile) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp());
  EXPECT_EQ(bench.master.Enable(kVelocity, bench.now), DriveAnswer::kModeNotInProfile);
  EXPECT_EQ(bench.master.stage(), DriveStage::kDisabled);
}

TEST(DriveMaster, FindsADriveThatBootsInFaultAndEnablesItOnlyAfterAReset) {
  DriveBench bench;
  bench.drive.power = PowerState::kFault;
  bench.drive.error_code = 0x3220;
  EXPECT_EQ(bench.master.Commission(bench.now), DriveAnswer::kAccepted);
  ASSERT_TRUE(bench.CycleUntil(DriveStage::kStopped));
  EXPECT_EQ(bench.master.trouble(), DriveTrouble::kFault);
  EXPECT_EQ(bench.master.TroubleWords(), "node 3: the drive is in fault: 3220h, DC link under-voltage");
  EXPECT_EQ(bench.master.Enable(kProfileVelocity, bench.now), DriveAnswer::kResetFirst);
  EXPECT_EQ(bench.master.ResetFault(bench.now), DriveAnswer::kAccepted);
  ASSERT_TRUE(bench.CycleUntil(DriveStage::kDisabled));
}

TEST(DriveMaster, DisablesAtOnceAndMayBeEnabledAgainWithoutAReset) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp(kProfileVelocity));
  bench.master.CommandSpeed(100.0);
  bench.Cycle();
  bench.Forget();
  bench.master.Disable(bench.now);
  bench.Deliver();  // without waiting for a SYNC
  EXPECT_EQ(bench.SentTo("203"), Texts{"000003"});
  EXPECT_EQ(bench.drive.power, PowerState::kSwitchOnDisabled);
  EXPECT_EQ(bench.drive.target_velocity, 0);
  EXPECT_EQ(bench.master.Enable(kProfileVelocity, bench.now), DriveAnswer::kAccepted);
  ASSERT_TRUE(bench.CycleUntil(DriveStage::kEnabled));
  bench.Cycle();
  EXPECT_EQ(bench.drive.target_velocity, 0);
}

TEST(DriveMaster, ShowsWhatTheDriveSaysInSi) {
  DriveBench bench;
  bench.drive.position = 1024;
  bench.drive.velocity = -60;
  bench.drive.torque = 500;
  ASSERT_TRUE(bench.BringUp());
  const DriveStatus& status = bench.master.status();
  EXPECT_FALSE(status.is_stale);
  EXPECT_DOUBLE_EQ(status.position_rad, 6.283185307179586 / 4.0);
  EXPECT_DOUBLE_EQ(status.speed_rad_per_s, -6.283185307179586);
  EXPECT_DOUBLE_EQ(status.torque_Nm, 0.5);
  EXPECT_EQ(status.power, PowerState::kSwitchOnDisabled);
  // Sampled at the SYNC before, not when the frame came in.
  EXPECT_EQ(status.time, bench.now - 4ms);
}

TEST(DriveMaster, RefusesAProfileThatCannotBeWithEveryFinding) {
  DriveProfile profile = EasyProfile();
  profile.units.rated_torque_Nm = 0.0;
  profile.supervision.drive_heartbeat_ms = 0;
  try {
    DriveMaster master(profile, 3);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(
        error.what(),
        "profile 'easy drive': rated_torque_Nm = 0 is not above zero; drive_heartbeat_ms = 0 switches "
        "the drive's heartbeat off");
  }
  EXPECT_THROW(DriveMaster(EasyProfile(), 0), std::invalid_argument);
}

}  // namespace
}  // namespace strainwave::protocols::canopen::drive_enable_test
