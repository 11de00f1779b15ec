// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/commissioning_steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "protocols/canopen/drive_image.h"
#include "protocols/canopen/type_limits.h"
#include "protocols/cia402.h"

namespace strainwave::protocols::canopen {
namespace {

using Action = CommissioningStep::Action;
using Concern = CommissioningStep::Concern;

constexpr std::uint32_t AllBits(unsigned bytes) {
  return bytes >= 4 ? 0xFFFFFFFF : (std::uint32_t{1} << (8 * bytes)) - 1;
}

// Collects the steps; an object that the drive lacks is left out in this one place.
class StepList {
 public:
  explicit StepList(const DriveProfile& profile) : profile_(profile) {}

  void Add(Action action, Concern concern, ObjectAddress address, unsigned bytes, std::int64_t value,
           std::uint32_t mask, std::string_view purpose) {
    if (IsAbsent(profile_, address.index)) return;
    steps_.push_back({action, concern, address, static_cast<std::uint8_t>(bytes),
                      static_cast<std::uint32_t>(value) & mask & AllBits(bytes), mask & AllBits(bytes),
                      std::string(purpose)});
  }

  void AddRatedTorque(double value, double units_per_Nm) {
    const std::size_t before = steps_.size();
    Add(Action::kExpect, Concern::kRatedTorque, {0x6076, 0}, 4, std::llround(value), 0xFFFFFFFF,
        "rated torque");
    if (steps_.size() == before) return;
    steps_.back().exact_value = value;
    steps_.back().units_per_Nm = units_per_Nm;
  }

  void Set(ObjectAddress address, unsigned bytes, std::int64_t value, std::string_view purpose) {
    Add(Action::kWrite, Concern::kSetting, address, bytes, value, AllBits(bytes), purpose);
    Add(Action::kExpect, Concern::kSetting, address, bytes, value, AllBits(bytes), purpose);
  }

  std::vector<CommissioningStep> Take() { return std::move(steps_); }

 private:
  const DriveProfile& profile_;
  std::vector<CommissioningStep> steps_;
};

bool Has(const DriveProfile& profile, OperationMode mode) {
  return std::find(profile.modes.begin(), profile.modes.end(), mode) != profile.modes.end();
}

void CheckIdentity(const DriveProfile& profile, StepList& list) {
  constexpr std::uint32_t kServoProfile = 402;
  list.Add(Action::kExpect, Concern::kIdentity, {0x1000, 0}, 4, kServoProfile, 0xFFFF, "device profile");
  const auto expect = [&list](std::uint8_t subindex, std::uint32_t value, std::string_view purpose) {
    if (value == 0) return;
    list.Add(Action::kExpect, Concern::kIdentity, {0x1018, subindex}, 4, value, 0xFFFFFFFF, purpose);
  };
  expect(1, profile.identity.vendor, "vendor");
  expect(2, profile.identity.product, "product");
  expect(3, profile.identity.revision, "revision");
}

void CheckAbility(const DriveProfile& profile, StepList& list) {
  std::uint32_t modes = 0;
  for (const OperationMode mode : profile.modes) modes |= SupportedModeBit(mode);
  list.Add(Action::kExpect, Concern::kAbility, {0x6502, 0}, 4, modes, modes, "supported modes");
  const double units_per_Nm = profile.units.rated_torque_units_per_Nm;
  list.AddRatedTorque(profile.units.rated_torque_Nm * units_per_Nm, units_per_Nm);
}

void SetSupervision(const DriveProfile& profile, StepList& list) {
  const Supervision& supervision = profile.supervision;
  list.Set({0x1017, 0}, 2, supervision.drive_heartbeat_ms, "heartbeat of the drive");
  list.Set({0x1016, 1}, 4, std::uint32_t{supervision.master_node_id} << 16 | supervision.master_timeout_ms,
           "watch over the master's heartbeat");
  list.Set({0x1029, 1}, 1, supervision.communication_error_behaviour, "behaviour when communication fails");
  const OptionCodes& codes = profile.option_codes;
  list.Set({0x6007, 0}, 2, codes.abort_connection, "abort connection option code");
  list.Set({0x605A, 0}, 2, codes.quick_stop, "quick stop option code");
  list.Set({0x605B, 0}, 2, codes.shutdown, "shutdown option code");
  list.Set({0x605C, 0}, 2, codes.disable_operation, "disable operation option code");
  list.Set({0x605D, 0}, 2, codes.halt, "halt option code");
  list.Set({0x605E, 0}, 2, codes.fault_reaction, "fault reaction option code");
}

void SetLimits(const DriveProfile& profile, StepList& list) {
  const DriveUnits& units = profile.units;
  const DriveLimits& limits = profile.limits;
  list.Set({0x6085, 0}, 4, AccelerationUnits(units, limits.quick_stop_deceleration_rad_per_s2),
           "quick stop deceleration");
  if (Has(profile, OperationMode::kProfilePosition)) {
    // Else a move would be as fast as whoever used the drive before has left it.
    list.Set({0x6081, 0}, 4, VelocityLimitUnits(units, limits.max_speed_rad_per_s),
             "speed of a profile move");
  }
  list.Set({0x6083, 0}, 4, AccelerationUnits(units, limits.acceleration_rad_per_s2), "acceleration");
  list.Set({0x6084, 0}, 4, AccelerationUnits(units, limits.acceleration_rad_per_s2), "deceleration");
  list.Set({0x6065, 0}, 4, PositionWindowCounts(units, limits.following_error_window_rad),
           "following error window");
  list.Set({0x6066, 0}, 2, limits.following_error_time_ms, "following error time");
  list.Set({0x6072, 0}, 2, TorqueLimitPerMille(units, limits.max_torque_Nm), "largest torque");
  list.Set({0x607F, 0}, 4, VelocityLimitUnits(units, limits.max_speed_rad_per_s), "largest speed");
}

void SetInterpolation(const DriveProfile& profile, StepList& list) {
  const bool is_cyclic = Has(profile, OperationMode::kCyclicPosition) ||
                         Has(profile, OperationMode::kCyclicVelocity) ||
                         Has(profile, OperationMode::kCyclicTorque);
  if (!is_cyclic) return;
  // 60C2h: a number of at most 255 and a power of ten, in seconds; milliseconds where they are whole, as not
  // every drive takes other powers.
  std::int64_t number = profile.timing.sync_period.count();
  int exponent = -9;
  while (number != 0 && number % 10 == 0) {
    number /= 10;
    ++exponent;
  }
  while (exponent > -3 && number <= 25) {
    number *= 10;
    --exponent;
  }
  list.Set({0x60C2, 1}, 1, number, "interpolation period");
  list.Set({0x60C2, 2}, 1, exponent, "interpolation period's power of ten");
}

void SetObjects(const DriveProfile& profile, StepList& list) {
  for (const ProfileObject& object : profile.objects) {
    const auto bytes = static_cast<unsigned>(BytesOf(object.type));
    switch (object.action) {
      case ProfileObject::Action::kWrite:
        list.Add(Action::kWrite, Concern::kSetting, object.address, bytes, object.value, AllBits(bytes),
                 object.purpose);
        break;
      case ProfileObject::Action::kWriteAndReadBack:
        list.Set(object.address, bytes, object.value, object.purpose);
        break;
      case ProfileObject::Action::kExpect:
        list.Add(Action::kExpect, Concern::kAbility, object.address, bytes, object.value, AllBits(bytes),
                 object.purpose);
        break;
    }
  }
}

// A campaign turns the shafts on for weeks, and the master counts on where 32 bits go over, but not where a
// drive goes over earlier, or stops. Soft limits are the profile's to set, where a shaft has ends.
void CheckEndless(const DriveProfile& profile, StepList& list) {
  const auto expect_none = [&list](ObjectAddress address, std::string_view purpose) {
    list.Add(Action::kExpectNoEnd, Concern::kEndless, address, 4, 0, 0xFFFFFFFF, purpose);
  };
  expect_none({0x607B, 1}, "lower end of the position range");
  expect_none({0x607B, 2}, "upper end of the position range");
  const auto is_soft_limit = [](const ProfileObject& object) { return object.address.index == 0x607D; };
  if (std::any_of(profile.objects.begin(), profile.objects.end(), is_soft_limit)) return;
  expect_none({0x607D, 1}, "lower soft limit of the position");
  expect_none({0x607D, 2}, "upper soft limit of the position");
}

void SetPdos(const std::vector<PdoSetting>& pdos, StepList& list) {
  for (const PdoSetting& pdo : pdos) {
    const std::string purpose =
        fmt::format("{}PDO {}", pdo.flow == PdoFlow::kToDrive ? "R" : "T", pdo.number);
    for (const PdoWrite& write : RemapWrites(pdo)) {
      list.Add(Action::kWrite, Concern::kSetting, write.address, write.bytes, write.value, ~write.keep,
               purpose);
    }
    for (const PdoWrite& read : RemapReadBack(pdo)) {
      list.Add(Action::kExpect, Concern::kSetting, read.address, read.bytes, read.value, ~read.keep, purpose);
    }
  }
}

// Under another id, or switched off, the master and the kernel's filters would never hear them. Behind the
// profile's own objects, so that a profile can put it right.
void CheckEmergencies(std::uint8_t node_id, StepList& list) {
  constexpr std::uint32_t kEmergency = 0x80;
  list.Add(Action::kExpect, Concern::kEmergencies, {0x1014, 0}, 4, kEmergency + node_id, 0xFFFFFFFF,
           "COB-ID of emergency messages");
}

bool MapsControlword(const PdoSetting& pdo) {
  return std::any_of(pdo.entries.begin(), pdo.entries.end(),
                     [](const PdoEntry& entry) { return entry.address == kControlwordObject; });
}

void CheckSupervision(const DriveProfile& profile, const std::vector<PdoSetting>& pdos, StepList& list) {
  const auto expect_on = [&list](ObjectAddress address, unsigned bytes, std::uint32_t off, std::uint32_t mask,
                                 std::string_view purpose) {
    list.Add(Action::kExpectNot, Concern::kSupervision, address, bytes, off, mask, purpose);
  };
  expect_on({0x1017, 0}, 2, 0, 0xFFFF, "heartbeat of the drive");
  expect_on({0x1016, 1}, 4, 0, 0x0000FFFF, "watch over the master's heartbeat");
  expect_on({0x1029, 1}, 1, 1, 0xFF, "behaviour when communication fails");
  expect_on({0x6007, 0}, 2, 0, 0xFFFF, "abort connection option code");
  for (const PdoSetting& pdo : pdos) {
    if (!MapsControlword(pdo) || profile.quirks.lacks_rpdo_event_timer) continue;
    expect_on({CommunicationIndex(pdo), 5}, 2, 0, 0xFFFF, "watch over the controlword");
  }
}

}  // namespace

std::vector<CommissioningStep> CommissioningSteps(const DriveProfile& profile, std::uint8_t node_id) {
  StepList list(profile);
  const std::vector<PdoSetting> pdos = PdosOf(profile, node_id);
  CheckIdentity(profile, list);
  CheckAbility(profile, list);
  // A drive that some program has left moving comes to rest before its settings change.
  list.Add(Action::kWrite, Concern::kSetting, kControlwordObject, 2, kControlwordQuickStop, 0xFFFF,
           "quick stop");
  SetSupervision(profile, list);
  SetLimits(profile, list);
  SetInterpolation(profile, list);
  SetObjects(profile, list);
  CheckEmergencies(node_id, list);
  CheckEndless(profile, list);
  SetPdos(pdos, list);
  CheckSupervision(profile, pdos, list);
  return list.Take();
}

}  // namespace strainwave::protocols::canopen
