// SPDX-License-Identifier: Apache-2.0
#include "bench/alarms/alarm_state.h"

namespace strainwave::bench {

std::string_view Name(AlarmInstanceState state) {
  switch (state) {
    case AlarmInstanceState::kRaised:
      return "raised";
    case AlarmInstanceState::kAcknowledged:
      return "acknowledged";
    case AlarmInstanceState::kReturned:
      return "returned";
    case AlarmInstanceState::kLatched:
      return "latched";
    case AlarmInstanceState::kShelvedRaised:
      return "shelved_raised";
    case AlarmInstanceState::kShelvedAcknowledged:
      return "shelved_acknowledged";
    case AlarmInstanceState::kShelvedReturned:
      return "shelved_returned";
    case AlarmInstanceState::kShelvedLatched:
      return "shelved_latched";
    case AlarmInstanceState::kShelvedCleared:
      return "shelved_cleared";
    case AlarmInstanceState::kCleared:
      return "cleared";
  }
  return "";
}

std::string_view Name(AlarmEvent event) {
  switch (event) {
    case AlarmEvent::kRaise:
      return "raise";
    case AlarmEvent::kReturn:
      return "return";
    case AlarmEvent::kAcknowledge:
      return "acknowledge";
    case AlarmEvent::kConfirm:
      return "confirm";
    case AlarmEvent::kShelve:
      return "shelve";
    case AlarmEvent::kUnshelve:
      return "unshelve";
    case AlarmEvent::kShelfOver:
      return "shelf_over";
    case AlarmEvent::kComment:
      return "comment";
  }
  return "";
}

std::optional<AlarmInstanceState> AlarmStateNamed(std::string_view name) {
  for (const AlarmInstanceState state : kAlarmStates) {
    if (Name(state) == name) return state;
  }
  return std::nullopt;
}

std::string_view Words(AlarmInstanceState state) {
  switch (state) {
    case AlarmInstanceState::kRaised:
      return "unacknowledged";
    case AlarmInstanceState::kAcknowledged:
      return "acknowledged";
    case AlarmInstanceState::kReturned:
      return "returned, unacknowledged";
    case AlarmInstanceState::kLatched:
      return "returned, acknowledged, latched until confirmed";
    case AlarmInstanceState::kShelvedRaised:
      return "shelved, unacknowledged";
    case AlarmInstanceState::kShelvedAcknowledged:
      return "shelved, acknowledged";
    case AlarmInstanceState::kShelvedReturned:
      return "shelved, returned, unacknowledged";
    case AlarmInstanceState::kShelvedLatched:
      return "shelved, returned, acknowledged, latched until confirmed";
    case AlarmInstanceState::kShelvedCleared:
      return "shelved, cleared";
    case AlarmInstanceState::kCleared:
      return "cleared";
  }
  return "";
}

bool IsActive(AlarmInstanceState state) {
  switch (state) {
    case AlarmInstanceState::kRaised:
    case AlarmInstanceState::kAcknowledged:
    case AlarmInstanceState::kShelvedRaised:
    case AlarmInstanceState::kShelvedAcknowledged:
      return true;
    case AlarmInstanceState::kReturned:
    case AlarmInstanceState::kLatched:
    case AlarmInstanceState::kShelvedReturned:
    case AlarmInstanceState::kShelvedLatched:
    case AlarmInstanceState::kShelvedCleared:
    case AlarmInstanceState::kCleared:
      return false;
  }
  return false;
}

bool IsAcknowledged(AlarmInstanceState state) {
  return !Next(state, AlarmEvent::kAcknowledge, false).has_value();
}

bool IsShelved(AlarmInstanceState state) { return Next(state, AlarmEvent::kShelfOver, false).has_value(); }

}  // namespace strainwave::bench
