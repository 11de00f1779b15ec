// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace strainwave::protocols::canopen {

/// What is wrong with a file, gathered so that its author sees everything at once.
class FileFindings {
 public:
  explicit FileFindings(std::string_view file_name) : file_name_(file_name) {}

  void Add(int line, int column, std::string what);
  /// @throws std::runtime_error with the findings in the order of the file, if there are any.
  void ThrowIfAny();

 private:
  struct Finding {
    int line;
    int column;
    std::string what;
  };
  std::string file_name_;
  std::vector<Finding> findings_;
};

struct IniValue {
  std::string text;  // without blanks at its ends
  int line{};
  int column{};  // of its first character
};

struct IniSection {
  std::string name;  // as written
  int line{};
  std::map<std::string, IniValue> values;  // by key in lower case

  /// Nothing when there is no such key; `key` in lower case.
  const IniValue* Find(std::string_view key) const;
};

std::string LowerCase(std::string_view text);

/// Sections by name in lower case, as an EDS file has them (CiA 306, 4.2): `[Name]`, `key=value`, comments
/// from
/// `;` at the beginning of a line, either end of line. A key or section that comes twice is a finding.
std::map<std::string, IniSection> ParseIni(std::string_view text, FileFindings& findings);

}  // namespace strainwave::protocols::canopen
