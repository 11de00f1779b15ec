// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocols/can_frame.h"
#include "protocols/canopen/nmt.h"
#include "protocols/canopen/sdo_client.h"

namespace strainwave::protocols::canopen {

/// What a node says of itself; of what it does not have, nothing.
struct FoundNode {
  std::uint8_t node_id{};
  std::optional<std::uint32_t> device_type{};                              // 1000h
  std::optional<std::uint32_t> vendor{}, product{}, revision{}, serial{};  // 1018h
  std::optional<NmtState> nmt_state{};  // of a heartbeat that came meanwhile
};

/// 1000h in words: "servo drive (CiA 402)".
std::string DeviceTypeWords(std::uint32_t device_type);

/// What it tells of 1018h, by name: {"vendor", "00005357h"}, …
std::vector<std::pair<std::string, std::string>> IdentityNumbers(const FoundNode& node);

/// Its identity for comparing and for people: "vendor 00005357h, product 00000402h, revision 00010000h,
/// serial 00000001h", as far as it tells; empty if nothing.
std::string IdentityText(const FoundNode& node);

/// Looks for nodes by asking them for what they are, all at the same time: uploads of 1000h and 1018h to each
/// default SDO, nothing else. A node that has none of them (its answers are aborts) is found all the same.
class NodeScan {
 public:
  /// Ends when all have said everything, when nothing has gone out or come in for `patience`, and after ten
  /// times that at the latest.
  /// @param nodes  that are asked; none: all 127.
  explicit NodeScan(std::chrono::nanoseconds patience, std::vector<std::uint8_t> nodes = {});

  void Start(std::chrono::nanoseconds now);
  void OnFrame(const CanFrame& frame, std::chrono::nanoseconds now) noexcept;
  /// The next frame to send, until there is none; asked again when the bus has taken it.
  std::optional<CanFrame> NextFrame(std::chrono::nanoseconds now) noexcept;
  bool IsDone(std::chrono::nanoseconds now) const noexcept;

  /// In the order in which they were asked.
  std::vector<FoundNode> Nodes() const;
  /// SYNC or NMT commands came: another program is at work on the bus.
  bool has_other_master() const noexcept { return has_other_master_; }

 private:
  struct Asked {
    explicit Asked(std::uint8_t node_id, std::chrono::nanoseconds timeout) : client(node_id, timeout) {
      node.node_id = node_id;
    }
    SdoClient client;
    FoundNode node;
    std::size_t object{};  // that is asked for
    bool has_answered{};
  };

  void TakeAnswer(Asked& asked, std::chrono::nanoseconds now) noexcept;

  std::chrono::nanoseconds patience_;
  std::vector<Asked> asked_;
  std::chrono::nanoseconds started_{};
  std::chrono::nanoseconds last_{};  // when something last went out or came in
  bool has_other_master_{};
};

}  // namespace strainwave::protocols::canopen
