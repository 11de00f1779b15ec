// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "schedules/reader/yaml_map.h"

namespace strainwave::bench {

/// The text of a file that a user named. @throws Error with what is wrong with the file itself.
template <typename Error>
std::string TextOfFile(const std::filesystem::path& path, const schedules::FileKind& kind) {
  schedules::FindingList findings;
  const std::optional<std::string> text = schedules::ReadInputFile(path, kind, findings);
  if (!text) throw Error(path.string(), findings);
  return *text;
}

/// What `read_top(root, context)` makes of a YAML text, which messages call `file_name`.
/// @throws Error with every finding, if there is one.
template <typename Error, typename ReadTop>
auto ParseFile(const std::string& text, std::string_view file_name, const schedules::FileKind& kind,
               ReadTop read_top) {
  schedules::ReadContext context;
  const auto root = schedules::ParseYaml(text, kind, context.findings);
  if (!root) throw Error(file_name, context.findings);
  auto made = read_top(*root, context);
  if (context.findings.has_errors()) throw Error(file_name, context.findings);
  return made;
}

}  // namespace strainwave::bench
