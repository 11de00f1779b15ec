// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "protocols/can_frame.h"
#include "protocols/canopen/object.h"
#include "protocols/canopen/pdo.h"

namespace strainwave::protocols::canopen {

inline constexpr ObjectAddress kControlwordObject{0x6040, 0};
inline constexpr ObjectAddress kStatuswordObject{0x6041, 0};
inline constexpr ObjectAddress kModeObject{0x6060, 0};
inline constexpr ObjectAddress kModeDisplayObject{0x6061, 0};
inline constexpr ObjectAddress kPositionActualObject{0x6064, 0};
inline constexpr ObjectAddress kVelocityActualObject{0x606C, 0};
inline constexpr ObjectAddress kTargetTorqueObject{0x6071, 0};
inline constexpr ObjectAddress kTorqueActualObject{0x6077, 0};
inline constexpr ObjectAddress kTargetPositionObject{0x607A, 0};
inline constexpr ObjectAddress kDigitalInputsObject{0x60FD, 0};
inline constexpr ObjectAddress kDigitalOutputsObject{0x60FE, 1};
inline constexpr ObjectAddress kTargetVelocityObject{0x60FF, 0};
inline constexpr ObjectAddress kErrorCodeObject{0x603F, 0};

/// What the master sends to a drive, in the drive's units.
struct DriveOutputs {
  std::uint16_t controlword{};
  std::int8_t mode{};
  std::int64_t target_position{};  // counted on; its lower 32 bits are sent
  std::int32_t target_velocity{};
  std::int16_t target_torque{};
  std::uint32_t digital_outputs{};
};

/// What a drive says, in its own units.
struct DriveInputs {
  std::uint16_t statusword{};
  std::int8_t mode_display{};
  std::int64_t position{};  // counted on where its 32 bits go over
  std::int32_t velocity{};
  std::int16_t torque{};
  std::uint32_t digital_inputs{};
  std::uint16_t error_code{};
};

/// Bits of an object that can be in a PDO of this direction; nothing for one that the master knows nothing
/// of.
std::optional<std::uint8_t> ImageBits(PdoFlow flow, ObjectAddress address) noexcept;

/// Nothing for a mapping that no frame holds.
std::optional<CanFrame> EncodeToDrive(const PdoSetting& pdo, const DriveOutputs& outputs) noexcept;

/// False, and nothing changes, if the frame is not exactly as long as the mapping. A position goes on from
/// the one before, whichever way round is shorter.
bool DecodeFromDrive(const PdoSetting& pdo, const CanFrame& frame, DriveInputs& inputs) noexcept;

}  // namespace strainwave::protocols::canopen
