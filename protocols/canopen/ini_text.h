// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/canopen/file_note.h"

namespace strainwave::protocols::canopen {

struct IniValue {
  std::string text;  // without blanks at its ends
  int line{};
  int column{};  // of its first character
};

struct IniSection {
  std::string name;  // as written
  int line{};
  int column{};                            // of its '['
  std::map<std::string, IniValue> values;  // by key in lower case

  /// Nothing when there is no such key; `key` in lower case.
  const IniValue* Find(std::string_view key) const;
};

std::string LowerCase(std::string_view text);

/// Sections by name in lower case, as an EDS file has them (CiA 306, 4.2): `[Name]`, `key=value`, comments
/// from `;` at the beginning of a line, either end of line. Of a key or section that comes twice the first
/// counts, a line that is neither is passed over; both are noted.
std::map<std::string, IniSection> ParseIni(std::string_view text, std::vector<FileNote>& notes);

}  // namespace strainwave::protocols::canopen
