// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "protocols/canopen/drive_profile.h"
#include "protocols/canopen/object.h"

namespace strainwave::protocols::canopen {

/// One step of a drive's boot, as data. `mask` has the bits that count: of a check those compared, of a write
/// those set, while the others stay as they are read before.
struct CommissioningStep {
  enum class Action : std::uint8_t {
    kExpect,
    kExpectNot,
    kExpectNoEnd,  // zero, or an end of 32 bits with a sign, or no such object
    kWrite,
  };
  /// What it means when the step fails.
  enum class Concern : std::uint8_t {
    kIdentity,     // another drive; nothing has been written yet
    kAbility,      // the drive cannot do what the profile says
    kRatedTorque,  // it counts torque by another motor, or in another unit
    kSetting,      // it does not take a value
    kSupervision,  // it would not notice that the master is gone
    kEmergencies,  // its emergency messages would not be heard
    kEndless,      // its position would not count on over any number of turns
  };

  Action action{};
  Concern concern{};
  ObjectAddress address;
  std::uint8_t bytes{};  // 1, 2 or 4
  std::uint32_t value{};
  std::uint32_t mask{0xFFFFFFFF};
  std::string purpose;
  double exact_value{};   // of the rated torque: before it was rounded
  double units_per_Nm{};  // of the rated torque

  bool operator==(const CommissioningStep&) const = default;
};

/// The boot of one drive: identity before anything else, what it can do, a quick stop, protective objects and
/// the profile's own written and read back, emergency messages where they are heard, a position without ends,
/// PDOs mapped anew and read back, and at last that every supervision reads as on.
/// @throws std::invalid_argument for a PDO that cannot be.
std::vector<CommissioningStep> CommissioningSteps(const DriveProfile& profile, std::uint8_t node_id);

}  // namespace strainwave::protocols::canopen
