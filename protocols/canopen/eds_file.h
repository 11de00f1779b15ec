// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/canopen/file_note.h"
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
  /// Why its type or access cannot be told, for whoever needs the object; empty as a rule.
  std::string unclear{};
  // Where its section begins, and where these values stand; of one that is missing, the section.
  FilePlace section_place{};
  FilePlace type_place{};
  FilePlace access_place{};
  FilePlace mapping_place{};
  FilePlace default_place{};
  FilePlace low_place{};
  FilePlace high_place{};
  FilePlace unclear_place{};
  bool is_set_for_node{};  // a DCF file: `default_value` is what this one node is set to
};

/// What a drive's maker says of it (CiA 306): identity and object dictionary.
struct EdsFile {
  std::string vendor_name;
  std::string product_name;
  std::optional<std::uint32_t> vendor_number;  // nothing where the file does not say
  std::optional<std::uint32_t> product_number;
  std::optional<std::uint32_t> revision_number;
  FilePlace vendor_place{};
  FilePlace product_place{};
  FilePlace revision_place{};
  /// By address; an object without sub-objects stands at sub-index 0.
  std::map<ObjectAddress, EdsObject> objects;
  /// What is odd about the file, in its order: "FILE:LINE:COLUMN: note: WHAT (what was expected)".
  std::vector<std::string> notes;
};

/// A number as an EDS file writes it for this node: decimal, 0x…, octal with a leading 0, "$NODEID+…"
/// or "…+$NODEID"; nothing for anything else.
std::optional<std::int64_t> EdsNumber(std::string_view text, std::uint8_t node_id);

/// Reads the text of an EDS or DCF file. Files of makers are odd in many places that nobody looks at, so what
/// departs from CiA 306 is noted: limits that contradict the type, one another or the default are left out,
/// an object in none of the lists is taken all the same, and one whose type or access cannot be told says so
/// in `unclear`.
/// @throws std::runtime_error, `FILE:1:1: error: WHAT (what was expected)`, if no object is described.
///   Messages call the file `file_name`.
EdsFile ParseEds(std::string_view text, std::string_view file_name);

}  // namespace strainwave::protocols::canopen
