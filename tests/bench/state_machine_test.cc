// SPDX-License-Identifier: Apache-2.0
#include "bench/safety/state_machine.h"

#include <compare>
#include <cstddef>
#include <optional>
#include <set>
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

// What has happened on the way to a state, as a person who watches would tell it.
struct Walk {
  BenchState state{BenchState::kFaulted};
  bool reset{};       // by a person, since the last fault
  bool started{};     // by a person, after the reset
  bool referenced{};  // since then
  auto operator<=>(const Walk&) const = default;
};

std::optional<Walk> After(Walk walk, BenchEvent event) {
  const auto next = Next(walk.state, event);
  if (!next) return std::nullopt;
  if (event == BenchEvent::kFault) walk = {};
  if (event == BenchEvent::kReset) walk.reset = true;
  if (event == BenchEvent::kStart) walk.started = walk.reset;
  if (event == BenchEvent::kReferenced) walk.referenced = walk.started;
  walk.state = *next;
  return walk;
}

// Every walk that there is, of any length.
std::set<Walk> AllWalks() {
  std::set<Walk> seen{Walk{}};
  std::vector<Walk> open{Walk{}};
  while (!open.empty()) {
    const Walk walk = open.back();
    open.pop_back();
    for (const BenchEvent event : kAllEvents) {
      const auto next = After(walk, event);
      if (next && seen.insert(*next).second) open.push_back(*next);
    }
  }
  return seen;
}

TEST(StateMachineSearch, ReachesEveryState) {
  std::set<BenchState> states;
  for (const Walk& walk : AllWalks()) states.insert(walk.state);
  EXPECT_EQ(states, std::set<BenchState>(kAllStates.begin(), kAllStates.end()));
}

TEST(StateMachineSearch, NothingHasTorqueBeforeAPersonHasResetAndStarted) {
  for (const Walk& walk : AllWalks()) {
    if (!TorqueAllowed(walk.state)) continue;
    EXPECT_TRUE(walk.reset && walk.started) << Name(walk.state);
    EXPECT_TRUE(walk.referenced || walk.state == BenchState::kUnwinding) << Name(walk.state);
  }
}

TEST(StateMachineSearch, NoPhaseFollowsAFaultWithoutAPerson) {
  for (const Walk& walk : AllWalks()) {
    const auto faulted = After(walk, BenchEvent::kFault);
    ASSERT_TRUE(faulted.has_value());
    EXPECT_EQ(*faulted, Walk{}) << "something of what was there before the fault is left";
    EXPECT_FALSE(TorqueAllowed(faulted->state));
  }
}

TEST(StateMachineSearch, ReachesASafeStateInOneStepAndTheEndFromEverywhere) {
  const auto walks = AllWalks();
  std::set<Walk> end;
  for (const Walk& walk : walks) {
    if (walk.state == BenchState::kFinished) end.insert(walk);
  }
  // Backwards, until nothing is added.
  for (std::size_t before = 0; before != end.size();) {
    before = end.size();
    for (const Walk& walk : walks) {
      for (const BenchEvent event : kAllEvents) {
        const auto next = After(walk, event);
        if (next && end.contains(*next)) end.insert(walk);
      }
    }
  }
  EXPECT_EQ(end, walks);
  for (const Walk& walk : walks) {
    if (!TorqueAllowed(walk.state)) continue;
    const auto ended = After(walk, BenchEvent::kPhaseEnded);
    ASSERT_TRUE(ended.has_value()) << Name(walk.state);
    EXPECT_FALSE(TorqueAllowed(ended->state)) << Name(walk.state);
  }
}

TEST(StateMachineSearch, OnePhaseDoesNotLeadIntoAnother) {
  for (const Walk& walk : AllWalks()) {
    for (const BenchEvent event : kAllEvents) {
      const auto next = After(walk, event);
      EXPECT_FALSE(next && TorqueAllowed(walk.state) && TorqueAllowed(next->state)) << Name(walk.state);
    }
  }
}

TEST(StateMachineSearch, StoringHasNoTorqueAndNothingEndsDuringIt) {
  for (const Walk& walk : AllWalks()) {
    if (walk.state == BenchState::kFinished) {
      EXPECT_TRUE(walk.referenced);
    }
    if (walk.state != BenchState::kStore) continue;
    for (const BenchEvent event : kAllEvents) {
      const auto next = After(walk, event);
      const bool allowed = event == BenchEvent::kStored || event == BenchEvent::kFault;
      EXPECT_EQ(next.has_value(), allowed);
    }
  }
}

// A number that no later version of this table can mean: nothing is allowed in it, and nothing turns.
TEST(StateMachine, AStateThatThereIsNotAllowsNothing) {
  const auto unknown = static_cast<BenchState>(99);
  for (const BenchEvent event : kAllEvents) {
    EXPECT_EQ(Next(unknown, event),
              event == BenchEvent::kFault ? std::optional(BenchState::kFaulted) : std::nullopt);
  }
  EXPECT_FALSE(TorqueAllowed(unknown));
  EXPECT_EQ(Next(BenchState::kReady, static_cast<BenchEvent>(99)), std::nullopt);
  EXPECT_EQ(Name(unknown), "?");
}

TEST(StateMachine, EveryStateHasANameOfItsOwn) {
  std::set<std::string_view> names;
  for (const BenchState state : kAllStates) names.insert(Name(state));
  EXPECT_EQ(names.size(), kAllStates.size());
  EXPECT_FALSE(names.contains("?"));
}

}  // namespace
}  // namespace strainwave::bench::state_machine_test
