// SPDX-License-Identifier: Apache-2.0
#include "bench/safety/drive_watch.h"

#include <gtest/gtest.h>

namespace strainwave::bench::drive_watch_test {
namespace {

using protocols::PowerState;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr nanoseconds kLongestSilence = milliseconds(100);

// Says what it is told to say.
class ToldDrive final : public ServoDrive {
 public:
  void Enable(DriveMode) noexcept override {}
  void Disable() noexcept override {}
  void QuickStop() noexcept override {}
  void ResetFault() noexcept override {}
  void SetBrake(bool) noexcept override {}
  void CommandSpeed(double) noexcept override {}
  void CommandPosition(double) noexcept override {}
  void CommandTorque(double) noexcept override {}
  DriveActual Actual() const noexcept override { return {}; }
};

class Watched : public testing::Test {
 protected:
  StopReason Says(PowerState power, bool brake_engaged, nanoseconds age = {}) {
    now_ += milliseconds(10);
    DriveActual actual;
    actual.time = now_ - age;
    actual.power = power;
    actual.brake_engaged = brake_engaged;
    return watch_.Check(actual, now_, kLongestSilence);
  }
  void ComeUp() {
    watch_.Enable(DriveMode::kTorque);
    EXPECT_FALSE(Says(PowerState::kOperationEnabled, true));
    watch_.SetBrake(false);
    EXPECT_FALSE(Says(PowerState::kOperationEnabled, false));
  }

  ToldDrive drive_;
  DriveWatch watch_{drive_, BenchServo::kLoad};
  nanoseconds now_{std::chrono::seconds(1)};
};

TEST_F(Watched, MayBeOffAsLongAsNobodyHasEnabledIt) {
  EXPECT_FALSE(Says(PowerState::kSwitchOnDisabled, true));
  ComeUp();
  watch_.QuickStop();
  EXPECT_FALSE(Says(PowerState::kQuickStopActive, true));
  EXPECT_FALSE(Says(PowerState::kSwitchOnDisabled, true));
}

TEST_F(Watched, TripsWhenItLeavesOperationEnabledByItselfWhateverItBecomes) {
  for (const PowerState power :
       {PowerState::kNotReadyToSwitchOn, PowerState::kSwitchOnDisabled, PowerState::kReadyToSwitchOn,
        PowerState::kSwitchedOn, PowerState::kQuickStopActive}) {
    watch_.QuickStop();
    ComeUp();
    const StopReason reason = Says(power, false);
    EXPECT_EQ(reason.cause, StopCause::kDriveDroppedOut);
    EXPECT_EQ(Describe(reason),
              "the load servo dropped out of operation enabled by itself: its enable input, safe torque off, "
              "supply or watchdog?");
  }
}

TEST_F(Watched, TripsWhenItsStateIsTooOldEnabledOrNot) {
  EXPECT_FALSE(Says(PowerState::kSwitchOnDisabled, true, kLongestSilence));
  StopReason reason = Says(PowerState::kSwitchOnDisabled, true, kLongestSilence + milliseconds(10));
  EXPECT_EQ(Describe(reason), "the load servo has not told its state for 110 ms (at most 100 ms)");
  ComeUp();
  reason = Says(PowerState::kOperationEnabled, false, milliseconds(150));
  EXPECT_EQ(reason.cause, StopCause::kDriveSilent);
}

TEST_F(Watched, GivesADriveThatHasNeverSpokenTheSameTimeFromTheBeginningOfAPhase) {
  now_ = std::chrono::seconds(5);
  watch_.Restart(now_);
  const nanoseconds ages_ago = std::chrono::hours(1);
  for (int period = 0; period < 10; ++period) {
    EXPECT_FALSE(Says(PowerState::kSwitchOnDisabled, true, ages_ago)) << period;
  }
  EXPECT_EQ(Says(PowerState::kSwitchOnDisabled, true, ages_ago).cause, StopCause::kDriveSilent);
}

TEST_F(Watched, TripsWhenABrakeThatWasReleasedIsOn) {
  ComeUp();
  EXPECT_FALSE(Says(PowerState::kOperationEnabled, true)) << "it may have dropped out, and tell that next";
  const StopReason reason = Says(PowerState::kOperationEnabled, true);
  EXPECT_EQ(Describe(reason),
            "the brake of the load servo is on though it was released: its relay, supply or feedback?");
}

TEST_F(Watched, TripsWhenItDoesNotComeUpWithItsBrakeOff) {
  watch_.Enable(DriveMode::kTorque);
  watch_.SetBrake(false);
  StopReason reason;
  nanoseconds begin = now_ + milliseconds(10);
  while (!reason && now_ < std::chrono::seconds(10)) reason = Says(PowerState::kOperationEnabled, true);
  EXPECT_EQ(Describe(reason),
            "the load servo did not reach operation enabled with its brake off within 3.0 s");
  EXPECT_EQ(now_ - begin, std::chrono::seconds(3) + milliseconds(10));
}

TEST_F(Watched, MayChangeItsModeThroughOtherStates) {
  ComeUp();
  watch_.Enable(DriveMode::kSpeed);
  EXPECT_FALSE(Says(PowerState::kSwitchedOn, false));
  EXPECT_FALSE(Says(PowerState::kOperationEnabled, false));
  EXPECT_EQ(Says(PowerState::kSwitchedOn, false).cause, StopCause::kDriveDroppedOut);
}

TEST_F(Watched, MayHaveItsBrakeOnUntilThatIsReleasedAndAfterItIsAskedFor) {
  watch_.Enable(DriveMode::kTorque);
  EXPECT_FALSE(Says(PowerState::kOperationEnabled, false));
  EXPECT_FALSE(Says(PowerState::kOperationEnabled, true)) << "nobody has released it";
  watch_.SetBrake(false);
  EXPECT_FALSE(Says(PowerState::kOperationEnabled, false));
  watch_.SetBrake(true);
  for (int period = 0; period < 5; ++period) EXPECT_FALSE(Says(PowerState::kOperationEnabled, true));
}

TEST_F(Watched, IsNotWatchedForItsStateOnceItIsStoppedOrSwitchedOff) {
  for (const bool quick : {true, false}) {
    ComeUp();
    quick ? watch_.QuickStop() : watch_.Disable();
    EXPECT_FALSE(Says(PowerState::kSwitchOnDisabled, true));
    EXPECT_EQ(Says(PowerState::kSwitchOnDisabled, true, milliseconds(101)).cause, StopCause::kDriveSilent);
  }
}

}  // namespace
}  // namespace strainwave::bench::drive_watch_test
