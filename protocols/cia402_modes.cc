// SPDX-License-Identifier: Apache-2.0
#include "protocols/cia402_modes.h"

namespace strainwave::protocols {

std::string_view Name(OperationMode mode) {
  switch (mode) {
    case OperationMode::kNone:
      return "no mode";
    case OperationMode::kProfilePosition:
      return "profile position";
    case OperationMode::kVelocity:
      return "velocity";
    case OperationMode::kProfileVelocity:
      return "profile velocity";
    case OperationMode::kProfileTorque:
      return "profile torque";
    case OperationMode::kHoming:
      return "homing";
    case OperationMode::kInterpolatedPosition:
      return "interpolated position";
    case OperationMode::kCyclicPosition:
      return "cyclic synchronous position";
    case OperationMode::kCyclicVelocity:
      return "cyclic synchronous velocity";
    case OperationMode::kCyclicTorque:
      return "cyclic synchronous torque";
  }
  return "not a mode of operation";
}

std::optional<OperationMode> OperationModeOf(std::int8_t number) {
  const auto mode = static_cast<OperationMode>(number);
  switch (mode) {
    case OperationMode::kNone:
    case OperationMode::kProfilePosition:
    case OperationMode::kVelocity:
    case OperationMode::kProfileVelocity:
    case OperationMode::kProfileTorque:
    case OperationMode::kHoming:
    case OperationMode::kInterpolatedPosition:
    case OperationMode::kCyclicPosition:
    case OperationMode::kCyclicVelocity:
    case OperationMode::kCyclicTorque:
      return mode;
  }
  return std::nullopt;
}

std::uint32_t SupportedModeBit(OperationMode mode) {
  const int number = static_cast<int>(mode);
  return number < 1 || number > 32 ? 0U : 1U << (number - 1);
}

StatusBits StatusBitsOf(OperationMode mode, std::uint16_t statusword) {
  const auto bit = [statusword](int number) { return (statusword >> number & 1) != 0; };
  StatusBits bits{.voltage_enabled = bit(4),
                  .warning = bit(7),
                  .remote = bit(9),
                  .target_reached = bit(10),
                  .internal_limit = bit(11)};
  switch (mode) {
    case OperationMode::kProfilePosition:
      bits.set_point_acknowledged = bit(12);
      bits.following_error = bit(13);
      break;
    case OperationMode::kProfileVelocity:
      bits.speed_is_zero = bit(12);
      bits.slippage_too_high = bit(13);
      break;
    case OperationMode::kHoming:
      bits.homing_attained = bit(12);
      bits.homing_error = bit(13);
      break;
    case OperationMode::kCyclicPosition:
      bits.follows_command = bit(12);
      bits.following_error = bit(13);
      break;
    case OperationMode::kInterpolatedPosition:
    case OperationMode::kCyclicVelocity:
    case OperationMode::kCyclicTorque:
      bits.follows_command = bit(12);
      break;
    case OperationMode::kNone:
    case OperationMode::kVelocity:
    case OperationMode::kProfileTorque:
      break;
  }
  return bits;
}

}  // namespace strainwave::protocols
