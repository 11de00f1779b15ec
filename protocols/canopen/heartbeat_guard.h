// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "protocols/can_frame.h"
#include "protocols/canopen/object_dictionary.h"

namespace strainwave::protocols::canopen::device {

/// Watches the heartbeats of other nodes as 1016h says (CiA 301, 7.2.8.3.2.2): from the first one that comes,
/// or from their boot-up message, each must follow within the consumer time.
class HeartbeatGuard {
 public:
  explicit HeartbeatGuard(ObjectDictionary& objects);

  void OnFrame(const CanFrame& frame, std::chrono::nanoseconds now);
  void Poll(std::chrono::nanoseconds now);

  /// A node that was heard is silent now.
  bool lost() const;

  void Reset();

 private:
  struct Watch {
    const Object* entry;  // 1016h:n: 0, node, milliseconds
    std::int64_t as_set{};
    bool heard{};
    bool lost{};
    std::chrono::nanoseconds last{};
  };
  static bool Watches(const Watch& watch, std::uint32_t id);

  std::vector<Watch> watches_;
};

}  // namespace strainwave::protocols::canopen::device
