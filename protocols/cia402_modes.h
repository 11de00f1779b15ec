// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace strainwave::protocols {

/// Modes of operation, by the numbers of objects 6060h and 6061h (IEC 61800-7-201).
enum class OperationMode : std::int8_t {
  kNone = 0,
  kProfilePosition = 1,
  kVelocity = 2,
  kProfileVelocity = 3,
  kProfileTorque = 4,
  kHoming = 6,
  kInterpolatedPosition = 7,
  kCyclicPosition = 8,
  kCyclicVelocity = 9,
  kCyclicTorque = 10,
};

std::string_view Name(OperationMode mode);

/// Nothing for a number that is reserved or the maker's own.
std::optional<OperationMode> OperationModeOf(std::int8_t number);

/// The mode's bit in the supported drive modes (6502h); of no mode none.
std::uint32_t SupportedModeBit(OperationMode mode);

/// The bits of the statusword (6041h) that do not tell the power state. Those that a mode does not define are
/// false, whatever the word says.
struct StatusBits {
  // In every mode.
  bool voltage_enabled{};  // bit 4: the power section has voltage
  bool warning{};          // bit 7
  bool remote{};           // bit 9: the drive follows the controlword
  bool target_reached{};   // bit 10
  bool internal_limit{};   // bit 11
  // By the mode: bit 12.
  bool set_point_acknowledged{};  // profile position
  bool speed_is_zero{};           // profile velocity
  bool homing_attained{};         // homing
  bool follows_command{};         // cyclic modes; interpolated position
  // By the mode: bit 13.
  bool following_error{};    // profile and cyclic position
  bool slippage_too_high{};  // profile velocity
  bool homing_error{};       // homing

  bool operator==(const StatusBits&) const = default;
};

StatusBits StatusBitsOf(OperationMode mode, std::uint16_t statusword);

/// Bits of the controlword (6040h) that only one mode reads; the halt bit (8) is never set by this master.
inline constexpr std::uint16_t kControlwordNewSetPoint = 0x0010;   // profile position, on the edge 0 to 1
inline constexpr std::uint16_t kControlwordChangeAtOnce = 0x0020;  // profile position
inline constexpr std::uint16_t kControlwordHomingStart = 0x0010;   // homing

}  // namespace strainwave::protocols
