// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/modbus/modbus_servo_fixture.h"

namespace strainwave::bench::modbus_watchdog_test {
namespace {

class WatchdogProofs : public Servo {
 protected:
  WatchdogProofs() { profile_.servo->watchdog_time = 200ms; }

  WatchdogProof Prove() {
    ModbusLink link(settings_, nullptr);
    link.Open();
    WatchdogProof proof = ProveWatchdog(link, profile_.map, *profile_.servo, clock_);
    EXPECT_TRUE(IsSafe());
    return proof;
  }
};

TEST_F(WatchdogProofs, MeasureHowLongADriveGoesOn) {
  const WatchdogProof proof = Prove();
  EXPECT_TRUE(proof.proven) << proof.words;
  EXPECT_GT(proof.time_to_stop, 200ms);
  EXPECT_TRUE(proof.words.ends_with("ms after the last write while it was still read")) << proof.words;
}

TEST_F(WatchdogProofs, RefuseAWatchdogThatReadingAloneKeepsQuiet) {
  model_.set_watchdog(ModbusServoModel::Watchdog::kAnything);
  const WatchdogProof proof = Prove();
  EXPECT_FALSE(proof.proven);
  EXPECT_EQ(
      proof.words,
      "the drive did not stop within 480 ms after the last write while it was read, but did within 480 ms of "
      "complete silence: reading alone keeps its watchdog quiet (expected a watchdog that only writing keeps "
      "quiet)");
}

TEST_F(WatchdogProofs, RefuseADriveWithoutAny) {
  model_.set_watchdog(ModbusServoModel::Watchdog::kNever);
  const WatchdogProof proof = Prove();
  EXPECT_FALSE(proof.proven);
  EXPECT_EQ(proof.words,
            "the drive did not stop within 480 ms after the last write while it was read, nor 480 ms after "
            "the last "
            "request of any kind: it has no watchdog (expected a watchdog that only writing keeps quiet)");
}

TEST_F(WatchdogProofs, RefuseATimeThatReadsBackOtherwise) {
  model_.set_fixed_watchdog_time(0.0);
  EXPECT_EQ(Prove().words,
            "the watchdog time was written as 0.2 s and reads back as 0 s (expected the same)");
}

// The model's watchdog ends in a fault, as that of many drives does.
TEST_F(WatchdogProofs, ResetTheFaultThatTheyMake) {
  for (int start = 1; start <= 2; ++start) {
    const WatchdogProof proof = Prove();
    EXPECT_TRUE(proof.proven) << "start " << start << ": " << proof.words;
    EXPECT_EQ(model_.power(clock_.Now()), PowerState::kSwitchOnDisabled);
  }
  RunAt(*Drive(), 20.0);
}

TEST_F(WatchdogProofs, ResetTheFaultThatTheyMakeAlsoWhereTheyRefuse) {
  model_.set_watchdog(ModbusServoModel::Watchdog::kAnything);
  EXPECT_FALSE(Prove().proven);
  EXPECT_EQ(model_.power(clock_.Now()), PowerState::kSwitchOnDisabled);
}

TEST_F(WatchdogProofs, ResetAFaultThatWasThereBeforeByOneEdge) {
  model_.Fault();
  EXPECT_TRUE(Prove().proven);
  const std::vector<std::string> written = model_.TakeWritten();
  const auto enabled = std::ranges::find(written, "control 1");
  ASSERT_NE(enabled, written.end());
  std::vector<std::string> control;
  for (auto line = written.begin(); line != enabled; ++line) {
    if (line->starts_with("control ")) control.push_back(*line);
  }
  const auto once = std::ranges::unique(control);
  control.erase(once.begin(), once.end());
  EXPECT_EQ(control, (std::vector<std::string>{"control 0", "control 4", "control 0"}));
}

TEST_F(WatchdogProofs, RefuseAFaultThatNoResetClearsWithItsCode) {
  takes_resets_ = false;
  fault_code_ = 17168.0;
  model_.Fault();
  const WatchdogProof proof = Prove();
  EXPECT_FALSE(proof.proven);
  EXPECT_EQ(proof.words,
            "the drive is in fault, code 17168 (4310h), and a reset does not clear it (expected a drive "
            "without a fault: mend its cause)");
  const std::vector<std::string> written = model_.TakeWritten();
  EXPECT_EQ(std::ranges::count(written, "control 1"), 0);
}

// It is the drive's own, and stays for a person to see.
TEST_F(WatchdogProofs, RefuseAFaultThatEnablingBringsWithItsCode) {
  faults_when_enabled_ = true;
  fault_code_ = 9.0;
  EXPECT_EQ(Prove().words,
            "the drive is in fault, code 9 (9h), when it is enabled at zero torque with its brake on");
  EXPECT_EQ(model_.power(clock_.Now()), PowerState::kFault);
}

}  // namespace
}  // namespace strainwave::bench::modbus_watchdog_test
