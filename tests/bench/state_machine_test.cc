// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/state_machine.h"

#include <vector>

#include <gtest/gtest.h>

namespace strainwave::bench::state_machine_test {
namespace {

const std::vector<BenchState> kAllStates{BenchState::kFaulted,
                                         BenchState::kIdle,
                                         BenchState::kReferencing,
                                         BenchState::kUnwinding,
                                         BenchState::kReady,
                                         BenchState::kLoadRun,
                                         BenchState::kMeasurementRotation,
                                         BenchState::kTransmissionErrorSweep,
                                         BenchState::kHysteresisTest,
                                         BenchState::kBlankTest,
                                         BenchState::kSoak,
                                         BenchState::kSensorCheck,
                                         BenchState::kSuspended,
                                         BenchState::kStore,
                                         BenchState::kFinished};
const std::vector<BenchEvent> kAllEvents{BenchEvent::kReset,
                                         BenchEvent::kStart,
                                         BenchEvent::kBeginUnwinding,
                                         BenchEvent::kReferenced,
                                         BenchEvent::kBeginLoadRun,
                                         BenchEvent::kBeginMeasurementRotation,
                                         BenchEvent::kBeginTransmissionErrorSweep,
                                         BenchEvent::kBeginHysteresisTest,
                                         BenchEvent::kBeginBlankTest,
                                         BenchEvent::kBeginSoak,
                                         BenchEvent::kBeginSensorCheck,
                                         BenchEvent::kPhaseEnded,
                                         BenchEvent::kSuspend,
                                         BenchEvent::kResume,
                                         BenchEvent::kBeginStore,
                                         BenchEvent::kStored,
                                         BenchEvent::kFinish,
                                         BenchEvent::kFault};

TEST(StateMachine, GoesThroughOneCycle) {
  BenchState state = BenchState::kFaulted;
  const std::vector<std::pair<BenchEvent, BenchState>> cycle{
      {BenchEvent::kReset, BenchState::kIdle},
      {BenchEvent::kStart, BenchState::kReferencing},
      {BenchEvent::kReferenced, BenchState::kReady},
      {BenchEvent::kBeginLoadRun, BenchState::kLoadRun},
      {BenchEvent::kPhaseEnded, BenchState::kReady},
      {BenchEvent::kBeginMeasurementRotation, BenchState::kMeasurementRotation},
      {BenchEvent::kPhaseEnded, BenchState::kReady},
      {BenchEvent::kBeginTransmissionErrorSweep, BenchState::kTransmissionErrorSweep},
      {BenchEvent::kPhaseEnded, BenchState::kReady},
      {BenchEvent::kBeginHysteresisTest, BenchState::kHysteresisTest},
      {BenchEvent::kPhaseEnded, BenchState::kReady},
      {BenchEvent::kBeginStore, BenchState::kStore},
      {BenchEvent::kStored, BenchState::kReady},
      {BenchEvent::kFinish, BenchState::kFinished}};
  for (const auto& [event, expected] : cycle) {
    const auto next = Next(state, event);
    ASSERT_TRUE(next.has_value()) << Name(state);
    state = *next;
    EXPECT_EQ(state, expected);
  }
}

TEST(StateMachine, EveryStateFaults) {
  for (const BenchState state : kAllStates) EXPECT_EQ(Next(state, BenchEvent::kFault), BenchState::kFaulted);
}

TEST(StateMachine, AFaultIsLeftOnlyByAResetAndTheResetDoesNotStart) {
  for (const BenchEvent event : kAllEvents) {
    const auto next = Next(BenchState::kFaulted, event);
    if (event == BenchEvent::kReset) {
      EXPECT_EQ(next, BenchState::kIdle);
    } else if (event != BenchEvent::kFault) {
      EXPECT_EQ(next, std::nullopt);
    }
  }
  EXPECT_FALSE(TorqueAllowed(BenchState::kIdle));
}

TEST(StateMachine, NoPhaseBeginsBeforeReferencingIsDone) {
  for (const BenchState state : {BenchState::kFaulted, BenchState::kIdle, BenchState::kReferencing}) {
    for (const BenchEvent event : kAllEvents) {
      const auto next = Next(state, event);
      EXPECT_FALSE(next && TorqueAllowed(*next) && next != BenchState::kUnwinding) << Name(state);
    }
  }
}

TEST(StateMachine, AGearIsUnwoundWithinReferencing) {
  for (const BenchState state : kAllStates) {
    const auto next = Next(state, BenchEvent::kBeginUnwinding);
    EXPECT_EQ(next, state == BenchState::kReferencing ? std::optional(BenchState::kUnwinding) : std::nullopt);
  }
  for (const BenchEvent event : kAllEvents) {
    const auto next = Next(BenchState::kUnwinding, event);
    if (event == BenchEvent::kPhaseEnded) {
      EXPECT_EQ(next, BenchState::kReferencing);
    } else if (event != BenchEvent::kFault) {
      EXPECT_EQ(next, std::nullopt);
    }
  }
}

TEST(StateMachine, LoadIsReachedFromReadyAlone) {
  for (const BenchState state : kAllStates) {
    for (const BenchEvent event : kAllEvents) {
      const auto next = Next(state, event);
      EXPECT_TRUE(!next || !TorqueAllowed(*next) || next == BenchState::kUnwinding ||
                  state == BenchState::kReady)
          << Name(state);
    }
  }
}

TEST(StateMachine, ASuspendedPhaseComesBackThroughReady) {
  EXPECT_EQ(Next(BenchState::kLoadRun, BenchEvent::kSuspend), BenchState::kSuspended);
  EXPECT_EQ(Next(BenchState::kSuspended, BenchEvent::kResume), BenchState::kReady);
  EXPECT_EQ(Next(BenchState::kReady, BenchEvent::kSuspend), std::nullopt);
}

}  // namespace
}  // namespace strainwave::bench::state_machine_test
