// SPDX-License-Identifier: Apache-2.0
#include "bench/alarms/alarm_state.h"
#include "tests/checkout.h"

#include <array>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace strainwave::bench::alarm_state_test {
namespace {

// What an alarm is, without its states: four things that are so or not so. A latching alarm that has
// returned and was acknowledged waits to be confirmed; one that has not returned, or was not, has nothing
// to confirm yet.
struct Facts {
  bool active{};
  bool acknowledged{};
  bool confirmed{};
  bool shelved{};
};

const std::map<AlarmInstanceState, Facts> kFacts{
    {AlarmInstanceState::kRaised, {true, false, false, false}},
    {AlarmInstanceState::kAcknowledged, {true, true, false, false}},
    {AlarmInstanceState::kReturned, {false, false, false, false}},
    {AlarmInstanceState::kLatched, {false, true, false, false}},
    {AlarmInstanceState::kCleared, {false, true, true, false}},
    {AlarmInstanceState::kShelvedRaised, {true, false, false, true}},
    {AlarmInstanceState::kShelvedAcknowledged, {true, true, false, true}},
    {AlarmInstanceState::kShelvedReturned, {false, false, false, true}},
    {AlarmInstanceState::kShelvedLatched, {false, true, false, true}},
    {AlarmInstanceState::kShelvedCleared, {false, true, true, true}},
};

AlarmInstanceState StateOf(const Facts& facts, bool latching) {
  const bool confirmed =
      facts.confirmed || (!facts.active && facts.acknowledged && !latching);  // nothing to wait for
  for (const auto& [state, of_state] : kFacts) {
    if (of_state.active == facts.active && of_state.acknowledged == facts.acknowledged &&
        of_state.confirmed == confirmed && of_state.shelved == facts.shelved)
      return state;
  }
  ADD_FAILURE() << "no state has these facts";
  return AlarmInstanceState::kCleared;
}

std::optional<AlarmInstanceState> Expected(AlarmInstanceState state, AlarmEvent event, bool latching) {
  Facts facts = kFacts.at(state);
  switch (event) {
    case AlarmEvent::kRaise:
      if (facts.confirmed) facts.acknowledged = false;  // that was of what is over
      facts.active = true;
      facts.confirmed = false;
      return StateOf(facts, latching);
    case AlarmEvent::kReturn:
      if (!facts.active) return std::nullopt;
      facts.active = false;
      return StateOf(facts, latching);
    case AlarmEvent::kAcknowledge:
      if (facts.acknowledged) return std::nullopt;
      facts.acknowledged = true;
      return StateOf(facts, latching);
    case AlarmEvent::kConfirm:
      if (facts.active || !facts.acknowledged || facts.confirmed) return std::nullopt;
      facts.confirmed = true;
      return StateOf(facts, latching);
    case AlarmEvent::kShelve:
      if (facts.shelved || facts.confirmed) return std::nullopt;
      facts.shelved = true;
      // Shelving changes nothing of what is below the shelf.
      for (const auto& [other, of_other] : kFacts) {
        if (of_other.active == facts.active && of_other.acknowledged == facts.acknowledged &&
            of_other.confirmed == facts.confirmed && of_other.shelved)
          return other;
      }
      return std::nullopt;
    case AlarmEvent::kUnshelve:
    case AlarmEvent::kShelfOver:
      if (!facts.shelved) return std::nullopt;
      for (const auto& [other, of_other] : kFacts) {
        if (of_other.active == facts.active && of_other.acknowledged == facts.acknowledged &&
            of_other.confirmed == facts.confirmed && !of_other.shelved)
          return other;
      }
      return std::nullopt;
    case AlarmEvent::kComment:
      return state;
  }
  return std::nullopt;
}

std::string NameOrNone(const std::optional<AlarmInstanceState>& state) {
  return state ? std::string(Name(*state)) : "–";
}

TEST(Next, DoesInEveryStateWithEveryEventWhatFollowsFromTheFacts) {
  ASSERT_EQ(kAlarmStates.size(), kFacts.size());
  for (const bool latching : {false, true}) {
    for (const AlarmInstanceState state : kAlarmStates) {
      for (const AlarmEvent event : kAlarmEvents) {
        EXPECT_EQ(NameOrNone(Next(state, event, latching)), NameOrNone(Expected(state, event, latching)))
            << Name(state) << ", " << Name(event) << (latching ? ", latching" : "");
      }
    }
  }
}

TEST(AlarmTransitions, AreThereOnceEach) {
  for (const AlarmInstanceState state : kAlarmStates) {
    for (const AlarmEvent event : kAlarmEvents) {
      int rows = 0;
      for (const AlarmTransition& row : kAlarmTransitions) rows += row.from == state && row.event == event;
      EXPECT_LE(rows, 1) << Name(state) << ", " << Name(event);
    }
  }
}

TEST(AlarmInstanceState, IsWhatItsFactsSay) {
  for (const auto& [state, facts] : kFacts) {
    EXPECT_EQ(IsActive(state), facts.active) << Name(state);
    EXPECT_EQ(IsShelved(state), facts.shelved) << Name(state);
    EXPECT_EQ(IsAcknowledged(state), facts.acknowledged) << Name(state);
    EXPECT_EQ(IsOpen(state), state != AlarmInstanceState::kCleared) << Name(state);
    EXPECT_EQ(AlarmStateNamed(Name(state)), state);
    EXPECT_FALSE(Words(state).empty());
  }
  EXPECT_EQ(AlarmStateNamed("raised "), std::nullopt);
}

// The page's table: a state a row, an event a column; "a / b" where an alarm that latches goes to b.
std::string Table() {
  std::ostringstream table;
  table << "| state |";
  for (const AlarmEvent event : kAlarmEvents) table << " " << Name(event) << " |";
  table << "\n| --- |";
  for (std::size_t i = 0; i < kAlarmEvents.size(); ++i) table << " --- |";
  table << "\n";
  for (const AlarmInstanceState state : kAlarmStates) {
    table << "| `" << Name(state) << "` |";
    for (const AlarmEvent event : kAlarmEvents) {
      const auto next = Next(state, event, false);
      const auto latching = Next(state, event, true);
      table << " " << (next ? Name(*next) : "–");
      if (next != latching) table << " / " << NameOrNone(latching);
      table << " |";
    }
    table << "\n";
  }
  return std::move(table).str();
}

TEST(AlarmTransitions, ArePrintedInTheDocumentAsTheyAre) {
  std::ifstream file(SourceFolder() + "/docs/bench/alarms.md");
  std::ostringstream page;
  page << file.rdbuf();
  EXPECT_NE(page.str().find(Table()), std::string::npos)
      << "docs/bench/alarms.md does not hold the table as it is now; expected:\n"
      << Table();
}

}  // namespace
}  // namespace strainwave::bench::alarm_state_test
