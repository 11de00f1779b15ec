// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/yaml_text.h"

#include <fmt/format.h>

#include <cstddef>
#include <string>

namespace strainwave::schedules {
namespace {

// A hundred times what any schedule needs; the parser takes up to 250 bytes of memory for one of the text.
constexpr std::size_t kLargestFile_bytes = std::size_t{1} << 20U;

bool IsControl(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return (byte < 0x20U && c != '\t' && c != '\n' && c != '\r') || byte == 0x7fU;
}

// Length of the UTF-8 sequence that begins `text` (RFC 3629, section 4), 0 if it is not one.
std::size_t SequenceLength(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned>(static_cast<unsigned char>(text[i])); };
  const unsigned lead = byte(0);
  if (lead < 0x80U) return 1;
  const std::size_t length = lead >= 0xc2U && lead < 0xe0U   ? 2
                             : lead >= 0xe0U && lead < 0xf0U ? 3
                             : lead >= 0xf0U && lead < 0xf5U ? 4
                                                             : 0;
  if (length == 0 || length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0U) != 0x80U) return 0;
  }
  const unsigned second = byte(1);
  const bool overlong = (lead == 0xe0U && second < 0xa0U) || (lead == 0xf0U && second < 0x90U);
  const bool beyond = (lead == 0xedU && second > 0x9fU) || (lead == 0xf4U && second > 0x8fU);
  return overlong || beyond ? 0 : length;
}

// The first byte that is not text, as a finding; the parser would take some of them as the end of the file.
bool CheckBytes(std::string_view line, int line_number, FindingList& findings) {
  for (std::size_t i = 0; i < line.size();) {
    const std::size_t length = IsControl(line[i]) ? 0 : SequenceLength(line.substr(i));
    if (length == 0) {
      findings.AddError(line_number, static_cast<int>(i) + 1,
                        fmt::format("byte 0x{:02x} is not text (expected UTF-8)",
                                    static_cast<unsigned>(static_cast<unsigned char>(line[i]))));
      return false;
    }
    i += length;
  }
  return true;
}

}  // namespace

std::string TooLargeMessage(std::size_t bytes, const FileKind& kind) {
  if (bytes <= kLargestFile_bytes) return {};
  return fmt::format("{:.1f} MB is too much for a {} (expected at most 1 MiB)",
                     static_cast<double>(bytes) * 1e-6, kind.noun);
}

std::string Shortened(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string result;
  std::size_t characters = 0;
  for (std::size_t i = 0; i < text.size();) {
    if (characters++ == kLongest) return result + "...";
    const std::size_t length = SequenceLength(text.substr(i));
    const bool printable =
        length > 0 && !IsControl(text[i]) && text[i] != '\n' && text[i] != '\r' && text[i] != '\t';
    result += printable ? text.substr(i, length) : std::string_view("?");
    i += length == 0 ? 1 : length;
  }
  return result;
}

void CheckYamlText(std::string_view text, const FileKind& kind, FindingList& findings) {
  if (std::string message = TooLargeMessage(text.size(), kind); !message.empty()) {
    findings.AddError(1, 1, std::move(message));
    return;
  }
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  bool empty = true;
  int line_number = 0;
  while (!text.empty()) {
    ++line_number;
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (!CheckBytes(line, line_number, findings)) return;
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string_view::npos || line[first] == '#') continue;
    empty = false;
    const std::size_t tab = line.substr(0, first).find('\t');
    if (tab != std::string_view::npos) {
      findings.AddError(line_number, static_cast<int>(tab) + 1, "tab in the indentation (expected spaces)");
    }
  }
  if (empty) {
    findings.AddError(
        1, 1,
        fmt::format("the file is empty (expected a {} that begins with '{}')", kind.noun, kind.first_line));
  }
}

}  // namespace strainwave::schedules
