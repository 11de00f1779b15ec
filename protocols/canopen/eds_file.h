// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "protocols/canopen/object.h"

namespace strainwave::protocols::canopen {

/// One object of an electronic data sheet.
struct EdsObject {
  std::string name;
  DataType type{};
  AccessType access{};
  bool mappable{};  // to a PDO
  // As written, "$NODEID+0x600" among them; empty where the file gives none.
  std::string default_value;
  std::string low_limit;
  std::string high_limit;
};

/// What a drive's maker says of it (CiA 306): identity and object dictionary.
struct EdsFile {
  std::string vendor_name;
  std::string product_name;
  std::uint32_t vendor_number{};
  std::uint32_t product_number{};
  std::uint32_t revision_number{};
  /// By address; an object without sub-objects stands at sub-index 0.
  std::map<ObjectAddress, EdsObject> objects;
};

/// A number as an EDS file writes it for this node: decimal, 0x…, octal with a leading 0, "$NODEID+…";
/// nothing for anything else.
std::optional<std::int64_t> EdsNumber(std::string_view text, std::uint8_t node_id);

/// Reads the text of an EDS or DCF file.
/// @throws std::runtime_error with every finding, one a line,
///   `FILE:LINE:COLUMN: error: WHAT (what was expected)`; messages call the file `file_name`.
EdsFile ParseEds(std::string_view text, std::string_view file_name);

}  // namespace strainwave::protocols::canopen
