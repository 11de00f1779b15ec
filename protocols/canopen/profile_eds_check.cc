// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "protocols/canopen/commissioning_steps.h"
#include "protocols/canopen/drive_profile.h"
#include "protocols/canopen/sdo_client.h"
#include "protocols/canopen/type_limits.h"

namespace strainwave::protocols::canopen {
namespace {

class EdsFindings {
 public:
  // Several steps touch the same object; each finding is told once.
  void Add(FilePlace place, std::string what) {
    if (std::ranges::none_of(notes_, [&](const FileNote& note) { return note.what == what; }))
      notes_.push_back({place.line, place.column, std::move(what)});
  }
  bool HaveOne(std::string_view beginning) const {
    return std::ranges::any_of(notes_,
                               [&](const FileNote& note) { return note.what.starts_with(beginning); });
  }
  std::vector<FileNote> Take() && { return std::move(notes_); }

 private:
  std::vector<FileNote> notes_;
};

std::string Named(ObjectAddress address, const EdsObject& object) {
  return fmt::format("{} {}", Words(address), object.name);
}

// Of the object, or of one beside it where it is missing.
FilePlace SectionOf(const EdsFile& eds, std::uint16_t index) {
  const auto found = eds.objects.lower_bound({index, 0});
  const bool is_there = found != eds.objects.end() && found->first.index == index;
  return is_there ? found->second.section_place : FilePlace{1, 1};
}

std::string LeftOutBy(std::string_view quirk) {
  return fmt::format(" (expected it there; where the drive lacks it, quirks: {{{}}} in the profile)", quirk);
}

bool Maps(const std::vector<PdoSetting>& pdos, std::uint16_t index) {
  return std::ranges::any_of(pdos, [index](const PdoSetting& pdo) {
    return std::ranges::any_of(pdo.entries,
                               [index](const PdoEntry& entry) { return entry.address.index == index; });
  });
}

// What the profile would say if the drive really lacked the object; nothing where no drive may.
std::string HowToLeaveOut(const CommissioningStep& step, const DriveProfile& profile) {
  const std::uint16_t index = step.address.index;
  if (index >= 0x1400 && index < 0x1C00) {
    // Left out, a drive would send and understand what somebody has once set it to.
    if (!profile.pdos.empty()) return " (expected only PDOs and entries that the drive has in pdos)";
    if (step.address.subindex == 5 && index < 0x1600) return LeftOutBy("lacks_rpdo_event_timer: true");
    if (step.address.subindex == 5 && index >= 0x1800 && index < 0x1A00)
      return LeftOutBy("lacks_tpdo_event_timer: true");
    return " (expected it there; the profile's pdos may name others)";
  }
  DriveProfile without = profile;
  without.quirks.absent_objects.push_back(index);
  const bool is_left_out =
      std::ranges::none_of(CommissioningSteps(without, 1),
                           [&](const CommissioningStep& other) { return other.address == step.address; });
  if (!is_left_out) return "";
  if (const std::vector<std::string> wrong = CheckProfile(without); !wrong.empty())
    return ": " + wrong.front();
  return LeftOutBy(fmt::format("absent_objects: [0x{:04X}]", index));
}

// The same for an object that is mapped.
std::string HowNotToMap(std::uint16_t index, const DriveProfile& profile) {
  if (!profile.pdos.empty()) return " (expected only objects that the drive can map in pdos)";
  DriveProfile without = profile;
  without.quirks.absent_objects.push_back(index);
  if (!Maps(StandardPdos(without), index) && CheckProfile(without).empty())
    return LeftOutBy(fmt::format("absent_objects: [0x{:04X}]", index));
  without.pdos = StandardPdos(profile);
  for (PdoSetting& pdo : without.pdos)
    std::erase_if(pdo.entries, [index](const PdoEntry& entry) { return entry.address.index == index; });
  std::erase_if(without.pdos, [](const PdoSetting& pdo) { return pdo.entries.empty(); });
  return CheckProfile(without).empty() ? " (expected it there; the profile's pdos may do without it)"
                                       : " (expected it there; the master cannot do without it)";
}

void CheckStep(const DriveProfile& profile, const CommissioningStep& step, const EdsFile& eds,
               std::uint8_t node_id, EdsFindings& findings) {
  const auto found = eds.objects.find(step.address);
  if (found == eds.objects.end()) {
    if (step.action == CommissioningStep::Action::kExpectNoEnd) return;  // none to be had
    // One object may be set and watched: it is told once.
    const std::string what = Words(step.address) + " (";
    if (findings.HaveOne(what)) return;
    findings.Add(SectionOf(eds, step.address.index),
                 fmt::format("{}{}) is not in the EDS{}", what, step.purpose, HowToLeaveOut(step, profile)));
    return;
  }
  const EdsObject& object = found->second;
  const std::string name = Named(step.address, object);
  if (!object.unclear.empty()) {
    findings.Add(object.unclear_place, fmt::format("{}: the EDS gives it {}", name, object.unclear));
    return;
  }
  if (BytesOf(object.type) != step.bytes) {
    findings.Add(object.type_place, fmt::format("{}: {} bytes in the profile, {} in the EDS", name,
                                                step.bytes, BytesOf(object.type)));
    return;
  }
  if (step.action != CommissioningStep::Action::kWrite) {
    if (object.access == AccessType::kWriteOnly) {
      findings.Add(object.access_place, fmt::format("{}: is read, but can only be written", name));
    }
    return;
  }
  if (object.access == AccessType::kReadOnly || object.access == AccessType::kConstant) {
    findings.Add(object.access_place, fmt::format("{}: is written, but can only be read", name));
  }
  const unsigned bits = 8U * step.bytes;
  const bool is_whole = step.mask == (bits >= 32 ? 0xFFFFFFFF : (1U << bits) - 1);
  if (!is_whole) return;  // bits within a number have no limits
  std::int64_t value = IsSignedType(object.type) ? SignExtended(step.value, bits) : step.value;
  const std::optional<std::int64_t> low = TypedEdsNumber(object.low_limit, node_id, object.type);
  const std::optional<std::int64_t> high = TypedEdsNumber(object.high_limit, node_id, object.type);
  // The watched node stands above bit 16 of 1016h: a limit of 16 bits is meant for the time below.
  if (step.address.index == 0x1016 && high && *high <= 0xFFFF) value &= 0xFFFF;
  if (low && value < *low) {
    findings.Add(object.low_place, fmt::format("{}: {} is below the EDS's low limit {}", name, value, *low));
  }
  if (high && value > *high) {
    findings.Add(object.high_place,
                 fmt::format("{}: {} is above the EDS's high limit {}", name, value, *high));
  }
}

void CheckMapped(const DriveProfile& profile, const PdoSetting& pdo, const EdsFile& eds,
                 EdsFindings& findings) {
  for (const PdoEntry& entry : pdo.entries) {
    const auto found = eds.objects.find(entry.address);
    if (found == eds.objects.end()) {
      findings.Add(SectionOf(eds, entry.address.index),
                   fmt::format("{} is mapped, but is not in the EDS{}", Words(entry.address),
                               HowNotToMap(entry.address.index, profile)));
      continue;
    }
    const EdsObject& object = found->second;
    const std::string name = Named(entry.address, object);
    if (!object.unclear.empty()) {
      findings.Add(object.unclear_place, fmt::format("{}: the EDS gives it {}", name, object.unclear));
      continue;
    }
    if (!object.mappable)
      findings.Add(object.mapping_place, fmt::format("{}: is mapped, but the EDS does not allow it{}", name,
                                                     HowNotToMap(entry.address.index, profile)));
    if (8 * BytesOf(object.type) != entry.bits) {
      findings.Add(object.type_place, fmt::format("{}: {} bits mapped, {} in the EDS", name, entry.bits,
                                                  8 * BytesOf(object.type)));
    }
    const bool is_to_drive = pdo.flow == PdoFlow::kToDrive;
    if (is_to_drive && (object.access == AccessType::kReadOnly || object.access == AccessType::kConstant)) {
      findings.Add(object.access_place,
                   fmt::format("{}: is mapped to be written, but can only be read", name));
    }
    if (!is_to_drive && object.access == AccessType::kWriteOnly) {
      findings.Add(object.access_place,
                   fmt::format("{}: is mapped to be read, but can only be written", name));
    }
  }
}

void CheckIdentity(std::string_view name, std::uint32_t profile, std::optional<std::uint32_t> eds,
                   FilePlace place, EdsFindings& findings) {
  if (profile != 0 && eds.value_or(0) != 0 && profile != *eds) {  // many a maker leaves a 0
    findings.Add(place, fmt::format("{} {:08X}h in the profile, {:08X}h in the EDS", name, profile, *eds));
  }
}

}  // namespace

std::vector<FileNote> CheckProfileAgainstEds(const DriveProfile& profile, const EdsFile& eds,
                                             std::uint8_t node_id) {
  EdsFindings findings;
  CheckIdentity("vendor", profile.identity.vendor, eds.vendor_number, eds.vendor_place, findings);
  CheckIdentity("product", profile.identity.product, eds.product_number, eds.product_place, findings);
  CheckIdentity("revision", profile.identity.revision, eds.revision_number, eds.revision_place, findings);
  // What is only read before a start may be left unread; a setting that is there must be made.
  DriveProfile whole = profile;
  whole.quirks.absent_objects.clear();
  const std::vector<CommissioningStep> all_steps = CommissioningSteps(whole, node_id);
  for (const std::uint16_t index : profile.quirks.absent_objects) {
    const auto is_read = [index](const CommissioningStep& step) {
      return step.address.index == index && step.action == CommissioningStep::Action::kExpect;
    };
    const auto is_written = [index](const CommissioningStep& step) {
      return step.address.index == index && step.action == CommissioningStep::Action::kWrite;
    };
    const bool is_looked_at = std::ranges::any_of(all_steps, is_read) ||
                              (Maps(PdosOf(whole, node_id), index) && !Maps(PdosOf(profile, node_id), index));
    if (is_looked_at && std::ranges::none_of(all_steps, is_written)) continue;
    const auto found = eds.objects.lower_bound({index, 0});
    if (found != eds.objects.end() && found->first.index == index) {
      findings.Add(SectionOf(eds, index),
                   fmt::format("{:04X}h is absent according to the profile, but is in the EDS", index));
    }
  }
  for (const CommissioningStep& step : CommissioningSteps(profile, node_id)) {
    CheckStep(profile, step, eds, node_id, findings);
  }
  for (const PdoSetting& pdo : PdosOf(profile, node_id)) CheckMapped(profile, pdo, eds, findings);
  return std::move(findings).Take();
}

}  // namespace strainwave::protocols::canopen
