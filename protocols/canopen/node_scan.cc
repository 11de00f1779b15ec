// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/node_scan.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "protocols/canopen/cob_ids.h"
#include "protocols/canopen/wire_bytes.h"

namespace strainwave::protocols::canopen {
namespace {

using std::chrono::nanoseconds;

constexpr std::uint8_t kMostNodes = 127;
constexpr int kLongestInPatiences = 10;

struct Question {
  ObjectAddress address;
  std::optional<std::uint32_t> FoundNode::*answer;
};
constexpr std::array<Question, 5> kQuestions{{{{0x1000, 0}, &FoundNode::device_type},
                                              {{0x1018, 1}, &FoundNode::vendor},
                                              {{0x1018, 2}, &FoundNode::product},
                                              {{0x1018, 3}, &FoundNode::revision},
                                              {{0x1018, 4}, &FoundNode::serial}}};

}  // namespace

// The profile's number is in the lower half, what of it the device is in the upper one (CiA 301, 7.5.2.1;
// of drives IEC 61800-7-201, 5.1). The other numbers are those of CiA's list of profiles.
std::string DeviceTypeWords(std::uint32_t device_type) {
  constexpr std::pair<std::uint16_t, const char*> kProfiles[] = {{401, "inputs and outputs"},
                                                                 {404, "measuring device or controller"},
                                                                 {405, "programmable controller"},
                                                                 {406, "encoder"},
                                                                 {408, "hydraulic drive"},
                                                                 {410, "inclinometer"},
                                                                 {418, "battery"},
                                                                 {419, "battery charger"}};
  constexpr std::pair<std::uint8_t, const char*> kDrives[] = {
      {1, "frequency converter"}, {2, "servo drive"}, {4, "stepper drive"}};
  const auto profile = static_cast<std::uint16_t>(device_type);
  if (profile == 0) return "device without a profile";
  if (profile == 402) {
    const auto kind = static_cast<std::uint8_t>(device_type >> 16);
    const auto* const drive = std::ranges::find(kDrives, kind, [](const auto& row) { return row.first; });
    return fmt::format("{} (CiA 402)", drive == std::end(kDrives) ? "drive" : drive->second);
  }
  const auto* const row =
      std::ranges::find(kProfiles, profile, [](const auto& known) { return known.first; });
  return fmt::format("{} (CiA {})", row == std::end(kProfiles) ? "device" : row->second, profile);
}

std::vector<std::pair<std::string, std::string>> IdentityNumbers(const FoundNode& node) {
  const std::pair<const char*, const std::optional<std::uint32_t>&> numbers[] = {{"vendor", node.vendor},
                                                                                 {"product", node.product},
                                                                                 {"revision", node.revision},
                                                                                 {"serial", node.serial}};
  std::vector<std::pair<std::string, std::string>> told;
  for (const auto& [name, number] : numbers) {
    if (number) told.emplace_back(name, fmt::format("{:08X}h", *number));
  }
  return told;
}

std::string IdentityText(const FoundNode& node) {
  std::string text;
  for (const auto& [name, number] : IdentityNumbers(node)) {
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, number);
  }
  return text;
}

NodeScan::NodeScan(nanoseconds patience, std::vector<std::uint8_t> nodes) : patience_(patience) {
  if (nodes.empty()) {
    nodes.resize(kMostNodes);
    std::iota(nodes.begin(), nodes.end(), std::uint8_t{1});
  }
  asked_.reserve(nodes.size());
  // The clients never run out of time by themselves, which would send an abort to nodes that are not there.
  for (const std::uint8_t node : nodes) asked_.emplace_back(node, 2 * kLongestInPatiences * patience);
}

void NodeScan::Start(nanoseconds now) {
  started_ = last_ = now;
  for (Asked& asked : asked_) {
    asked.client.Reset();
    asked.node = {.node_id = asked.node.node_id};
    asked.object = 0;
    asked.has_answered = false;
    (void)asked.client.StartUpload(kQuestions[0].address, 0, SdoTransfer::kExpeditedOrSegmented, now);
  }
}

void NodeScan::TakeAnswer(Asked& asked, nanoseconds now) noexcept {
  if (asked.client.state() == SdoClient::State::kBusy || asked.object == kQuestions.size()) return;
  last_ = now;
  if (asked.client.state() == SdoClient::State::kDone) {
    const auto data = asked.client.data();
    if (data.size() == sizeof(std::uint32_t)) {
      asked.node.*kQuestions[asked.object].answer = static_cast<std::uint32_t>(FromLittleEndian(data));
    }
  }
  asked.has_answered = true;
  if (++asked.object == kQuestions.size()) return;
  (void)asked.client.StartUpload(kQuestions[asked.object].address, 0, SdoTransfer::kExpeditedOrSegmented,
                                 now);
}

void NodeScan::OnFrame(const CanFrame& frame, nanoseconds now) noexcept {
  if (frame.error || frame.remote || frame.extended) return;
  const std::uint32_t function = frame.id & ~std::uint32_t{0x7F};
  const std::uint32_t node = frame.id & 0x7F;
  has_other_master_ = has_other_master_ || frame.id == 0x080 || frame.id == 0x000;
  const auto found = std::ranges::find(asked_, node, [](const Asked& asked) { return asked.node.node_id; });
  if (found == asked_.end()) return;
  Asked& asked = *found;
  if (function == kHeartbeatBase && frame.length == 1) {
    asked.node.nmt_state = NmtStateOf(frame.data[0]);
  } else if (function == 0x580) {
    asked.client.OnFrame(frame, now);
    TakeAnswer(asked, now);
  }
}

std::optional<CanFrame> NodeScan::NextFrame(nanoseconds now) noexcept {
  for (Asked& asked : asked_) {
    if (const auto frame = asked.client.Poll(now)) {
      last_ = now;
      return frame;
    }
  }
  return std::nullopt;
}

bool NodeScan::IsDone(nanoseconds now) const noexcept {
  const bool all_told =
      std::ranges::all_of(asked_, [](const Asked& asked) { return asked.object == kQuestions.size(); });
  return all_told || now - last_ >= patience_ || now - started_ >= kLongestInPatiences * patience_;
}

std::vector<FoundNode> NodeScan::Nodes() const {
  std::vector<FoundNode> found;
  for (const Asked& asked : asked_) {
    if (asked.has_answered || asked.node.nmt_state) found.push_back(asked.node);
  }
  return found;
}

}  // namespace strainwave::protocols::canopen
