// SPDX-License-Identifier: Apache-2.0
#include "protocols/cia402.h"

namespace strainwave::protocols {
namespace {

// Which bits of the statusword (6041h) tell a state: 0 ready to switch on, 1 switched on, 2 operation
// enabled, 3 fault, 5 quick stop (low when active), 6 switch on disabled. The rest (voltage, warning, maker's
// bits, mode bits) says nothing about the state.
struct StatuswordPattern {
  std::uint16_t mask;
  std::uint16_t value;
  PowerState state;
};

constexpr StatuswordPattern kStatuswords[] = {
    {0x004F, 0x0000, PowerState::kNotReadyToSwitchOn},   // x0xx 0000
    {0x004F, 0x0040, PowerState::kSwitchOnDisabled},     // x1xx 0000
    {0x006F, 0x0021, PowerState::kReadyToSwitchOn},      // x01x 0001
    {0x006F, 0x0023, PowerState::kSwitchedOn},           // x01x 0011
    {0x006F, 0x0027, PowerState::kOperationEnabled},     // x01x 0111
    {0x006F, 0x0007, PowerState::kQuickStopActive},      // x00x 0111
    {0x004F, 0x000F, PowerState::kFaultReactionActive},  // x0xx 1111
    {0x004F, 0x0008, PowerState::kFault},                // x0xx 1000
};

// A command is a pattern of the controlword (6040h): bit 0 switch on, 1 enable voltage, 2 quick stop (low
// stops), 3 enable operation, 7 fault reset.
struct Command {
  std::uint16_t mask;
  std::uint16_t value;
  bool rising_edge_only;
};

constexpr Command kShutdown{0x0087, 0x0006, false};          // 0xxx x110
constexpr Command kSwitchOn{0x0087, 0x0007, false};          // 0xxx x111
constexpr Command kEnableOperation{0x008F, 0x000F, false};   // 0xxx 1111
constexpr Command kDisableOperation{0x008F, 0x0007, false};  // 0xxx 0111
constexpr Command kDisableVoltage{0x0082, 0x0000, false};    // 0xxx xx0x
constexpr Command kQuickStop{0x0086, 0x0002, false};         // 0xxx x01x
constexpr Command kFaultReset{0x0080, 0x0080, true};         // 1xxx xxxx after 0xxx xxxx

struct Transition {
  int number;  // of the standard
  PowerState from;
  Command command;
  PowerState to;
};

// The commands that leave one state exclude each other, so the order of lines does not matter. Transitions 7
// and 10 have two commands each. Transition 3 answers to 'switch on + enable operation' as well: the drive
// then takes 4 when it sees the same controlword again.
constexpr Transition kTransitions[] = {
    {2, PowerState::kSwitchOnDisabled, kShutdown, PowerState::kReadyToSwitchOn},
    {3, PowerState::kReadyToSwitchOn, kSwitchOn, PowerState::kSwitchedOn},
    {4, PowerState::kSwitchedOn, kEnableOperation, PowerState::kOperationEnabled},
    {5, PowerState::kOperationEnabled, kDisableOperation, PowerState::kSwitchedOn},
    {6, PowerState::kSwitchedOn, kShutdown, PowerState::kReadyToSwitchOn},
    {7, PowerState::kReadyToSwitchOn, kDisableVoltage, PowerState::kSwitchOnDisabled},
    {7, PowerState::kReadyToSwitchOn, kQuickStop, PowerState::kSwitchOnDisabled},
    {8, PowerState::kOperationEnabled, kShutdown, PowerState::kReadyToSwitchOn},
    {9, PowerState::kOperationEnabled, kDisableVoltage, PowerState::kSwitchOnDisabled},
    {10, PowerState::kSwitchedOn, kDisableVoltage, PowerState::kSwitchOnDisabled},
    {10, PowerState::kSwitchedOn, kQuickStop, PowerState::kSwitchOnDisabled},
    {11, PowerState::kOperationEnabled, kQuickStop, PowerState::kQuickStopActive},
    {12, PowerState::kQuickStopActive, kDisableVoltage, PowerState::kSwitchOnDisabled},
    {15, PowerState::kFault, kFaultReset, PowerState::kSwitchOnDisabled},
    {16, PowerState::kQuickStopActive, kEnableOperation, PowerState::kOperationEnabled},
};

bool Gives(const Command& command, std::uint16_t previous_controlword, std::uint16_t controlword) {
  const bool given = (controlword & command.mask) == command.value;
  const bool given_before = (previous_controlword & command.mask) == command.value;
  return given && !(command.rising_edge_only && given_before);
}

}  // namespace

std::string_view Name(PowerState state) {
  switch (state) {
    case PowerState::kNotReadyToSwitchOn:
      return "not ready to switch on";
    case PowerState::kSwitchOnDisabled:
      return "switch on disabled";
    case PowerState::kReadyToSwitchOn:
      return "ready to switch on";
    case PowerState::kSwitchedOn:
      return "switched on";
    case PowerState::kOperationEnabled:
      return "operation enabled";
    case PowerState::kQuickStopActive:
      return "quick stop active";
    case PowerState::kFaultReactionActive:
      return "fault reaction active";
    case PowerState::kFault:
      return "fault";
  }
  return "not a power state";
}

std::optional<PowerState> PowerStateOf(std::uint16_t statusword) {
  for (const StatuswordPattern& pattern : kStatuswords) {
    if ((statusword & pattern.mask) == pattern.value) return pattern.state;
  }
  return std::nullopt;
}

std::optional<std::uint16_t> ControlwordTowardsEnabled(PowerState state) {
  switch (state) {
    case PowerState::kSwitchOnDisabled:
      return kShutdown.value;
    case PowerState::kReadyToSwitchOn:
      return kSwitchOn.value;
    case PowerState::kSwitchedOn:
    case PowerState::kOperationEnabled:
      return kEnableOperation.value;
    case PowerState::kQuickStopActive:
      // Transition 16 would be shorter, but exists only under quick-stop option codes (605Ah) 5 to 8, and
      // turns a stop straight into motion; 12 is always there.
      return kDisableVoltage.value;
    case PowerState::kNotReadyToSwitchOn:
    case PowerState::kFaultReactionActive:
    case PowerState::kFault:
      return std::nullopt;
  }
  return std::nullopt;
}

PowerState NextPowerState(PowerState state, std::uint16_t previous_controlword, std::uint16_t controlword) {
  for (const Transition& transition : kTransitions) {
    if (transition.from == state && Gives(transition.command, previous_controlword, controlword)) {
      return transition.to;
    }
  }
  return state;
}

}  // namespace strainwave::protocols
