// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/ini_text.h"

#include <algorithm>

#include <fmt/format.h>

namespace strainwave::protocols::canopen {
namespace {

constexpr std::string_view kBlanks = " \t";

std::string_view Trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

}  // namespace

const IniValue* IniSection::Find(std::string_view key) const {
  const auto found = values.find(std::string(key));
  return found == values.end() ? nullptr : &found->second;
}

std::string LowerCase(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return lower;
}

std::map<std::string, IniSection> ParseIni(std::string_view text, std::vector<FileNote>& notes) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  std::map<std::string, IniSection> sections;
  IniSection* section = nullptr;
  bool passed_over = false;  // within a section that comes twice
  int number = 0;
  while (!text.empty()) {
    ++number;
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    while (line.ends_with('\r')) line.remove_suffix(1);  // two where a file was converted twice
    const std::string_view content = Trimmed(line);
    if (content.empty() || content.front() == ';') continue;
    const auto column_of = [&](std::string_view part) {
      return static_cast<int>(part.data() - line.data()) + 1;
    };

    if (content.front() == '[') {
      if (content.back() != ']' || Trimmed(content.substr(1, content.size() - 2)).empty()) {
        notes.push_back({number, column_of(content), "not the head of a section (expected '[NAME]')"});
        passed_over = true;
        continue;
      }
      const std::string_view name = Trimmed(content.substr(1, content.size() - 2));
      const auto [place, fresh] = sections.try_emplace(
          LowerCase(name), IniSection{std::string(name), number, column_of(content), {}});
      if (!fresh) {
        notes.push_back({number, column_of(name),
                         fmt::format("section [{}] comes twice (expected once; first on line {})", name,
                                     place->second.line)});
      }
      section = &place->second;
      passed_over = !fresh;
      continue;
    }

    const std::size_t equals = content.find('=');
    const std::string_view key = Trimmed(content.substr(0, equals));
    if (equals == std::string_view::npos || key.empty()) {
      notes.push_back(
          {number, column_of(content),
           "neither a section nor a value (expected '[NAME]', 'KEY=VALUE' or a comment after ';')"});
      continue;
    }
    if (passed_over) continue;
    if (section == nullptr) {
      notes.push_back({number, column_of(content),
                       fmt::format("'{}' stands before the first section (expected '[NAME]' first)", key)});
      continue;
    }
    const std::string_view value = Trimmed(content.substr(equals + 1));
    const int column = value.empty() ? column_of(content) + static_cast<int>(equals) + 1 : column_of(value);
    const auto [place, fresh] =
        section->values.try_emplace(LowerCase(key), IniValue{std::string(value), number, column});
    if (!fresh) {
      notes.push_back({number, column_of(key),
                       fmt::format("'{}' comes twice in [{}] (expected once; first on line {})", key,
                                   section->name, place->second.line)});
    }
  }
  return sections;
}

}  // namespace strainwave::protocols::canopen
