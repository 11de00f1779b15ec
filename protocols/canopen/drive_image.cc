// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/drive_image.h"

#include <array>

namespace strainwave::protocols::canopen {
namespace {

std::int64_t OutputValue(const DriveOutputs& outputs, ObjectAddress address) {
  if (address == kControlwordObject) return outputs.controlword;
  if (address == kModeObject) return outputs.mode;
  if (address == kTargetPositionObject) return outputs.target_position;
  if (address == kTargetVelocityObject) return outputs.target_velocity;
  if (address == kTargetTorqueObject) return outputs.target_torque;
  if (address == kDigitalOutputsObject) return outputs.digital_outputs;
  return 0;
}

// After 2^31 counts 6064h goes over to the other sign: 32 768 turns of 65 536 counts.
std::int64_t CountedOn(std::int64_t before, std::uint64_t sent) {
  return before +
         static_cast<std::int32_t>(static_cast<std::uint32_t>(sent) - static_cast<std::uint32_t>(before));
}

void SetInput(DriveInputs& inputs, ObjectAddress address, std::uint64_t value) {
  if (address == kStatuswordObject) inputs.statusword = static_cast<std::uint16_t>(value);
  if (address == kModeDisplayObject) inputs.mode_display = static_cast<std::int8_t>(value);
  if (address == kPositionActualObject) inputs.position = CountedOn(inputs.position, value);
  if (address == kVelocityActualObject) inputs.velocity = static_cast<std::int32_t>(value);
  if (address == kTorqueActualObject) inputs.torque = static_cast<std::int16_t>(value);
  if (address == kDigitalInputsObject) inputs.digital_inputs = static_cast<std::uint32_t>(value);
  if (address == kErrorCodeObject) inputs.error_code = static_cast<std::uint16_t>(value);
}

}  // namespace

std::optional<std::uint8_t> ImageBits(PdoFlow flow, ObjectAddress address) noexcept {
  switch (flow) {
    case PdoFlow::kToDrive:
      if (address == kModeObject) return 8;
      if (address == kControlwordObject || address == kTargetTorqueObject) return 16;
      if (address == kTargetPositionObject || address == kTargetVelocityObject ||
          address == kDigitalOutputsObject) {
        return 32;
      }
      return std::nullopt;
    case PdoFlow::kFromDrive:
      if (address == kModeDisplayObject) return 8;
      if (address == kStatuswordObject || address == kTorqueActualObject || address == kErrorCodeObject) {
        return 16;
      }
      if (address == kPositionActualObject || address == kVelocityActualObject ||
          address == kDigitalInputsObject) {
        return 32;
      }
      return std::nullopt;
  }
  return std::nullopt;
}

std::optional<CanFrame> EncodeToDrive(const PdoSetting& pdo, const DriveOutputs& outputs) noexcept {
  std::array<std::int64_t, 64> values{};
  if (pdo.entries.size() > values.size()) return std::nullopt;
  for (std::size_t i = 0; i < pdo.entries.size(); ++i) {
    values[i] = OutputValue(outputs, pdo.entries[i].address);
  }
  return PackPdo(pdo.cob_id, pdo.entries, std::span(values).first(pdo.entries.size()));
}

bool DecodeFromDrive(const PdoSetting& pdo, const CanFrame& frame, DriveInputs& inputs) noexcept {
  if (pdo.entries.empty()) return false;
  for (std::size_t i = 0; i < pdo.entries.size(); ++i) {
    const std::optional<std::uint64_t> value = PdoValue(frame, pdo.entries, i);
    if (!value) return false;
    SetInput(inputs, pdo.entries[i].address, *value);
  }
  return true;
}

}  // namespace strainwave::protocols::canopen
