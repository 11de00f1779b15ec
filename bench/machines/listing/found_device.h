// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace strainwave::bench {

/// One thing that was found, for people and for JSON.
struct FoundDevice {
  std::string where;  // "can0, node 3"
  std::string what;   // in words
  /// The same in figures, and what else is known of it.
  std::vector<std::pair<std::string, std::variant<std::int64_t, std::string>>> fields;
  std::string profile;  // the file that describes such a device; empty: none of ours
};

/// All of one kind.
struct FoundPart {
  std::string kind;  // "can"
  std::vector<FoundDevice> devices;
  std::vector<std::string> notes;  // why nothing, or not all, could be listed, and what to do
};

}  // namespace strainwave::bench
