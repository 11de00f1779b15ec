// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace strainwave::bench {

/// One alarm instance, as ISA-18.2 has it: whether its condition is there, whether a person has acknowledged
/// it, and whether it is shelved. The shelved states keep what the instance is under its shelf.
enum class AlarmInstanceState {
  kRaised,
  kAcknowledged,
  kReturned,
  kLatched,
  kShelvedRaised,
  kShelvedAcknowledged,
  kShelvedReturned,
  kShelvedLatched,
  kShelvedCleared,
  kCleared,
};

enum class AlarmEvent {
  kRaise,        // again, where that is counted on this instance
  kReturn,       // the condition has gone
  kAcknowledge,  // a person has seen it
  kConfirm,      // a person has mended the cause
  kShelve,
  kUnshelve,
  kShelfOver,  // its time has run out
  kComment,
};

inline constexpr std::array kAlarmStates{
    AlarmInstanceState::kRaised,          AlarmInstanceState::kAcknowledged,
    AlarmInstanceState::kReturned,        AlarmInstanceState::kLatched,
    AlarmInstanceState::kShelvedRaised,   AlarmInstanceState::kShelvedAcknowledged,
    AlarmInstanceState::kShelvedReturned, AlarmInstanceState::kShelvedLatched,
    AlarmInstanceState::kShelvedCleared,  AlarmInstanceState::kCleared};
inline constexpr std::array kAlarmEvents{
    AlarmEvent::kRaise,  AlarmEvent::kReturn,   AlarmEvent::kAcknowledge, AlarmEvent::kConfirm,
    AlarmEvent::kShelve, AlarmEvent::kUnshelve, AlarmEvent::kShelfOver,   AlarmEvent::kComment};

/// Stored and told: "raised", "shelved_returned", …
std::string_view Name(AlarmInstanceState state);
std::string_view Name(AlarmEvent event);
/// The state of that name; none where it is no state's.
std::optional<AlarmInstanceState> AlarmStateNamed(std::string_view name);
/// For people: "returned, unacknowledged".
std::string_view Words(AlarmInstanceState state);

struct AlarmTransition {
  AlarmInstanceState from;
  AlarmEvent event;
  AlarmInstanceState to;
  AlarmInstanceState to_latching;  // of an alarm that latches
};

/// Every transition there is; docs/bench/alarms.md prints this table, and a test compares the two.
inline constexpr std::array kAlarmTransitions = [] {
  using enum AlarmInstanceState;
  using enum AlarmEvent;
  return std::array{
      AlarmTransition{kRaised, kRaise, kRaised, kRaised},
      AlarmTransition{kRaised, kReturn, kReturned, kReturned},
      AlarmTransition{kRaised, kAcknowledge, kAcknowledged, kAcknowledged},
      AlarmTransition{kRaised, kShelve, kShelvedRaised, kShelvedRaised},
      AlarmTransition{kRaised, kComment, kRaised, kRaised},
      AlarmTransition{kAcknowledged, kRaise, kAcknowledged, kAcknowledged},
      AlarmTransition{kAcknowledged, kReturn, kCleared, kLatched},
      AlarmTransition{kAcknowledged, kShelve, kShelvedAcknowledged, kShelvedAcknowledged},
      AlarmTransition{kAcknowledged, kComment, kAcknowledged, kAcknowledged},
      AlarmTransition{kReturned, kRaise, kRaised, kRaised},
      AlarmTransition{kReturned, kAcknowledge, kCleared, kLatched},
      AlarmTransition{kReturned, kShelve, kShelvedReturned, kShelvedReturned},
      AlarmTransition{kReturned, kComment, kReturned, kReturned},
      AlarmTransition{kLatched, kRaise, kAcknowledged, kAcknowledged},
      AlarmTransition{kLatched, kConfirm, kCleared, kCleared},
      AlarmTransition{kLatched, kShelve, kShelvedLatched, kShelvedLatched},
      AlarmTransition{kLatched, kComment, kLatched, kLatched},
      AlarmTransition{kShelvedRaised, kRaise, kShelvedRaised, kShelvedRaised},
      AlarmTransition{kShelvedRaised, kReturn, kShelvedReturned, kShelvedReturned},
      AlarmTransition{kShelvedRaised, kAcknowledge, kShelvedAcknowledged, kShelvedAcknowledged},
      AlarmTransition{kShelvedRaised, kUnshelve, kRaised, kRaised},
      AlarmTransition{kShelvedRaised, kShelfOver, kRaised, kRaised},
      AlarmTransition{kShelvedRaised, kComment, kShelvedRaised, kShelvedRaised},
      AlarmTransition{kShelvedAcknowledged, kRaise, kShelvedAcknowledged, kShelvedAcknowledged},
      AlarmTransition{kShelvedAcknowledged, kReturn, kShelvedCleared, kShelvedLatched},
      AlarmTransition{kShelvedAcknowledged, kUnshelve, kAcknowledged, kAcknowledged},
      AlarmTransition{kShelvedAcknowledged, kShelfOver, kAcknowledged, kAcknowledged},
      AlarmTransition{kShelvedAcknowledged, kComment, kShelvedAcknowledged, kShelvedAcknowledged},
      AlarmTransition{kShelvedReturned, kRaise, kShelvedRaised, kShelvedRaised},
      AlarmTransition{kShelvedReturned, kAcknowledge, kShelvedCleared, kShelvedLatched},
      AlarmTransition{kShelvedReturned, kUnshelve, kReturned, kReturned},
      AlarmTransition{kShelvedReturned, kShelfOver, kReturned, kReturned},
      AlarmTransition{kShelvedReturned, kComment, kShelvedReturned, kShelvedReturned},
      AlarmTransition{kShelvedLatched, kRaise, kShelvedAcknowledged, kShelvedAcknowledged},
      AlarmTransition{kShelvedLatched, kConfirm, kShelvedCleared, kShelvedCleared},
      AlarmTransition{kShelvedLatched, kUnshelve, kLatched, kLatched},
      AlarmTransition{kShelvedLatched, kShelfOver, kLatched, kLatched},
      AlarmTransition{kShelvedLatched, kComment, kShelvedLatched, kShelvedLatched},
      AlarmTransition{kShelvedCleared, kRaise, kShelvedRaised, kShelvedRaised},
      AlarmTransition{kShelvedCleared, kUnshelve, kCleared, kCleared},
      AlarmTransition{kShelvedCleared, kShelfOver, kCleared, kCleared},
      AlarmTransition{kShelvedCleared, kComment, kShelvedCleared, kShelvedCleared},
      AlarmTransition{kCleared, kRaise, kRaised, kRaised},
      AlarmTransition{kCleared, kComment, kCleared, kCleared},
  };
}();

/// Nothing where the event is not allowed in that state.
constexpr std::optional<AlarmInstanceState> Next(AlarmInstanceState state, AlarmEvent event, bool latching) {
  for (const AlarmTransition& transition : kAlarmTransitions) {
    if (transition.from != state || transition.event != event) continue;
    return latching ? transition.to_latching : transition.to;
  }
  return std::nullopt;
}

/// Whether it is still listed: there is something to know of it or to do about it.
constexpr bool IsOpen(AlarmInstanceState state) { return state != AlarmInstanceState::kCleared; }
/// Whether its condition is there.
bool IsActive(AlarmInstanceState state);
bool IsShelved(AlarmInstanceState state);
/// Whether a person has seen it.
bool IsAcknowledged(AlarmInstanceState state);

}  // namespace strainwave::bench
