// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace strainwave::protocols {

/// Power states of a drive (CiA 402-2 / IEC 61800-7-201, finite state automaton).
enum class PowerState : std::uint8_t {
  kNotReadyToSwitchOn,
  kSwitchOnDisabled,
  kReadyToSwitchOn,
  kSwitchedOn,
  kOperationEnabled,
  kQuickStopActive,
  kFaultReactionActive,
  kFault,
};

std::string_view Name(PowerState state);

/// The state that a statusword (object 6041h) reports; nothing when its bits fit no state, which is an error
/// of the drive or of the bus and never to be guessed over.
std::optional<PowerState> PowerStateOf(std::uint16_t statusword);

/// The controlword (object 6040h) that takes a drive one transition from `state` towards operation enabled;
/// nothing where there is no way by a command (the drive moves on by itself, or a fault must be reset first).
/// In operation enabled it is the one that stays there; from quick stop active the way leads through switch
/// on disabled (transition 12), so that a stop never turns into motion by one word.
std::optional<std::uint16_t> ControlwordTowardsEnabled(PowerState state);

inline constexpr std::uint16_t kControlwordDisableVoltage = 0x0000;
inline constexpr std::uint16_t kControlwordQuickStop = 0x0002;   // bit 2 low, voltage enabled
inline constexpr std::uint16_t kControlwordFaultReset = 0x0080;  // acts on the edge 0 to 1

/// The state that follows when a drive in `state` sees `controlword` after `previous_controlword`
/// (transitions 2 to 12, 15 and 16 of the automaton; the ones that a drive makes by itself are not here).
/// At most one transition a call; a controlword that asks for none leaves the state as it is.
PowerState NextPowerState(PowerState state, std::uint16_t previous_controlword, std::uint16_t controlword);

}  // namespace strainwave::protocols
