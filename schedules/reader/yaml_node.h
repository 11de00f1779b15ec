// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schedules/reader/findings.h"

namespace strainwave::schedules {

/// The kind of file that is being read, for messages.
struct FileKind {
  std::string_view noun;        // "schedule"
  std::string_view first_line;  // "schedule: 1"
};

/// One value of a YAML file with its place. Keys and values of a map alternate in `children`, in file order,
/// so that a key that is there twice can be seen.
struct YamlNode {
  enum class Type { kNull, kScalar, kSequence, kMap };

  Type type{Type::kNull};
  std::string text;  // of a scalar
  int line{};
  int column{};
  std::vector<YamlNode> children;
};

/// The text of a file of at most 1 MiB; larger ones are refused before they are read.
/// @return nothing, with a finding added, if the file is missing, unreadable or too large.
std::optional<std::string> ReadInputFile(const std::filesystem::path& path, const FileKind& kind,
                                         FindingList& findings);

/// Reads one YAML document whose top is a map. Anchors, aliases and tags are refused, nesting is limited to
/// 16 levels and the number of values to 100 000: neither kind of file needs more, and what expands without
/// bound must not.
/// @return nothing, with findings added, if the text is empty or too large, is not UTF-8 text, has tabs in
///   its indentation, or is not such a document.
std::optional<YamlNode> ParseYaml(const std::string& text, const FileKind& kind, FindingList& findings);

}  // namespace strainwave::schedules
