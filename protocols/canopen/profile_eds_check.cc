// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "protocols/canopen/commissioning_steps.h"
#include "protocols/canopen/drive_profile.h"
#include "protocols/canopen/sdo_client.h"
#include "protocols/canopen/type_limits.h"

namespace strainwave::protocols::canopen {
namespace {

using Findings = std::vector<std::string>;

std::string Named(ObjectAddress address, const EdsObject& object) {
  return fmt::format("{} {}", Words(address), object.name);
}

void CheckStep(const CommissioningStep& step, const EdsFile& eds, std::uint8_t node_id, Findings& findings) {
  const auto found = eds.objects.find(step.address);
  if (found == eds.objects.end()) {
    if (step.action == CommissioningStep::Action::kExpectNoEnd) return;  // none to be had
    findings.push_back(fmt::format("{} ({}) is not in the EDS", Words(step.address), step.purpose));
    return;
  }
  const EdsObject& object = found->second;
  const std::string name = Named(step.address, object);
  if (BytesOf(object.type) != step.bytes) {
    findings.push_back(
        fmt::format("{}: {} bytes in the profile, {} in the EDS", name, step.bytes, BytesOf(object.type)));
    return;
  }
  if (step.action != CommissioningStep::Action::kWrite) {
    if (object.access == AccessType::kWriteOnly) {
      findings.push_back(fmt::format("{}: is read, but can only be written", name));
    }
    return;
  }
  if (object.access == AccessType::kReadOnly || object.access == AccessType::kConstant) {
    findings.push_back(fmt::format("{}: is written, but can only be read", name));
  }
  const unsigned bits = 8U * step.bytes;
  const bool is_whole = step.mask == (bits >= 32 ? 0xFFFFFFFF : (1U << bits) - 1);
  if (!is_whole) return;  // bits within a number have no limits
  const std::int64_t value = IsSignedType(object.type) ? SignExtended(step.value, bits) : step.value;
  const std::optional<std::int64_t> low = EdsNumber(object.low_limit, node_id);
  const std::optional<std::int64_t> high = EdsNumber(object.high_limit, node_id);
  if (low && value < *low) {
    findings.push_back(fmt::format("{}: {} is below the EDS's low limit {}", name, value, *low));
  }
  if (high && value > *high) {
    findings.push_back(fmt::format("{}: {} is above the EDS's high limit {}", name, value, *high));
  }
}

void CheckMapped(const PdoSetting& pdo, const EdsFile& eds, Findings& findings) {
  for (const PdoEntry& entry : pdo.entries) {
    const auto found = eds.objects.find(entry.address);
    if (found == eds.objects.end()) {
      findings.push_back(fmt::format("{} is mapped, but is not in the EDS", Words(entry.address)));
      continue;
    }
    const EdsObject& object = found->second;
    const std::string name = Named(entry.address, object);
    if (!object.mappable)
      findings.push_back(fmt::format("{}: is mapped, but the EDS does not allow it", name));
    if (8 * BytesOf(object.type) != entry.bits) {
      findings.push_back(
          fmt::format("{}: {} bits mapped, {} in the EDS", name, entry.bits, 8 * BytesOf(object.type)));
    }
    const bool is_to_drive = pdo.flow == PdoFlow::kToDrive;
    if (is_to_drive && (object.access == AccessType::kReadOnly || object.access == AccessType::kConstant)) {
      findings.push_back(fmt::format("{}: is mapped to be written, but can only be read", name));
    }
    if (!is_to_drive && object.access == AccessType::kWriteOnly) {
      findings.push_back(fmt::format("{}: is mapped to be read, but can only be written", name));
    }
  }
}

void CheckIdentity(std::string_view name, std::uint32_t profile, std::uint32_t eds, Findings& findings) {
  if (profile != 0 && profile != eds) {
    findings.push_back(fmt::format("{} {:08X}h in the profile, {:08X}h in the EDS", name, profile, eds));
  }
}

}  // namespace

std::vector<std::string> CheckProfileAgainstEds(const DriveProfile& profile, const EdsFile& eds,
                                                std::uint8_t node_id) {
  Findings findings;
  CheckIdentity("vendor", profile.identity.vendor, eds.vendor_number, findings);
  CheckIdentity("product", profile.identity.product, eds.product_number, findings);
  CheckIdentity("revision", profile.identity.revision, eds.revision_number, findings);
  for (const std::uint16_t index : profile.quirks.absent_objects) {
    const auto found = eds.objects.lower_bound({index, 0});
    if (found != eds.objects.end() && found->first.index == index) {
      findings.push_back(fmt::format("{:04X}h is absent according to the profile, but is in the EDS", index));
    }
  }
  for (const CommissioningStep& step : CommissioningSteps(profile, node_id)) {
    CheckStep(step, eds, node_id, findings);
  }
  for (const PdoSetting& pdo : PdosOf(profile, node_id)) CheckMapped(pdo, eds, findings);
  // Several steps touch the same object; each finding is told once.
  Findings once;
  for (std::string& finding : findings) {
    if (std::find(once.begin(), once.end(), finding) == once.end()) once.push_back(std::move(finding));
  }
  return once;
}

}  // namespace strainwave::protocols::canopen
