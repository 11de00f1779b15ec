// SPDX-License-Identifier: Apache-2.0
#include "daq/csv_text.h"

#include <algorithm>

namespace strainwave::daq {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t'; }

// In UTF-8, of Unicode's category Zs those that are met in files.
constexpr std::string_view kWideBlanks[] = {"\u00A0", "\u2007", "\u2009", "\u202F"};

// Bytes of the blank that the text begins or ends with; 0 if there is none.
std::size_t BlankBefore(std::string_view text) {
  if (text.empty() || IsBlank(text.front())) return text.empty() ? 0 : 1;
  const auto* const wide =
      std::ranges::find_if(kWideBlanks, [text](auto blank) { return text.starts_with(blank); });
  return wide == std::end(kWideBlanks) ? 0 : wide->size();
}
std::size_t BlankBehind(std::string_view text) {
  if (text.empty() || IsBlank(text.back())) return text.empty() ? 0 : 1;
  const auto* const wide =
      std::ranges::find_if(kWideBlanks, [text](auto blank) { return text.ends_with(blank); });
  return wide == std::end(kWideBlanks) ? 0 : wide->size();
}

// Bytes of the UTF-8 sequence at the start of `text`, at least one; 0 if there is none.
std::size_t SequenceLength(std::string_view text) {
  const auto byte = [text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  const std::size_t length = lead < 0x80   ? 1
                             : lead < 0xC2 ? 0
                             : lead < 0xE0 ? 2
                             : lead < 0xF0 ? 3
                             : lead < 0xF5 ? 4
                                           : 0;
  if (length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  // Longer forms than needed, surrogates, and code points beyond U+10FFFF.
  if ((lead == 0xE0 && byte(1) < 0xA0) || (lead == 0xED && byte(1) > 0x9F) ||
      (lead == 0xF0 && byte(1) < 0x90) || (lead == 0xF4 && byte(1) > 0x8F)) {
    return 0;
  }
  return length;
}

Cell TakeQuotedCell(std::string_view line, std::size_t& at) {
  Cell cell{.text = {}, .column = static_cast<int>(at) + 1};
  ++at;
  for (; at < line.size(); ++at) {
    if (line[at] == '"') {
      if (at + 1 == line.size() || line[at + 1] != '"') {
        ++at;
        break;
      }
      ++at;
    }
    cell.text += line[at];
  }
  return cell;
}

}  // namespace

Line TakeLine(std::string_view& rest) {
  const std::size_t end = rest.find('\n');
  Line line{.text = rest.substr(0, end), .has_end = end != rest.npos};
  rest.remove_prefix(line.has_end ? end + 1 : rest.size());
  if (line.has_end && line.text.ends_with('\r')) line.text.remove_suffix(1);
  return line;
}

std::string_view Trim(std::string_view text) {
  while (const std::size_t blank = BlankBefore(text)) text.remove_prefix(blank);
  while (const std::size_t blank = BlankBehind(text)) text.remove_suffix(blank);
  return text;
}

std::vector<Cell> SplitCells(std::string_view line, char separator) {
  std::vector<Cell> cells;
  std::size_t at = 0;
  while (true) {
    while (at < line.size() && IsBlank(line[at]) && line[at] != separator) ++at;
    const bool quoted = at < line.size() && line[at] == '"';
    Cell cell = quoted ? TakeQuotedCell(line, at) : Cell{.text = {}, .column = static_cast<int>(at) + 1};
    const std::size_t end = std::min(line.find(separator, at), line.size());
    // After a closing quote only blanks are left, in a well-formed file; anything else stays part of the
    // cell.
    cell.text += Trim(line.substr(at, end - at));
    cells.push_back(std::move(cell));
    if (end == line.size()) return cells;
    at = end + 1;
  }
}

std::optional<std::size_t> FindNonTextByte(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const auto byte = static_cast<unsigned char>(text[at]);
    if (byte >= 0x20 && byte < 0x7F) {
      ++at;
      continue;
    }
    if (byte < 0x20 && byte != '\t' && byte != '\n' && byte != '\r') return at;
    const std::size_t length = byte == 0x7F ? 0 : SequenceLength(text.substr(at));
    if (length == 0) return at;
    at += length;
  }
  return std::nullopt;
}

std::string Quoted(std::string_view text) {
  constexpr std::size_t kMost = 40;
  std::string quoted = "'";
  if (text.size() <= kMost) {
    quoted += text;
  } else {
    // Not in the middle of a letter.
    std::size_t end = kMost;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
    quoted += text.substr(0, end);
    quoted += "...";
  }
  return quoted + "'";
}

}  // namespace strainwave::daq
