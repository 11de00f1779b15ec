// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/unicode_spaces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace strainwave::schedules {
namespace {

// Bytes of the UTF-8 sequence whose first byte is `lead`.
std::size_t LengthOf(char lead) {
  const auto byte = static_cast<unsigned char>(lead);
  return byte < 0xC0U ? 1 : byte < 0xE0U ? 2 : byte < 0xF0U ? 3 : 4;
}

char32_t CodePoint(std::string_view sequence) {
  if (sequence.size() == 1) return static_cast<unsigned char>(sequence[0]);
  char32_t code = static_cast<unsigned char>(sequence[0]) & (0x7FU >> sequence.size());
  for (const char c : sequence.substr(1)) code = code << 6U | (static_cast<unsigned char>(c) & 0x3FU);
  return code;
}

bool IsSpace(char32_t code) {
  return code == 0xA0 || code == 0x1680 || (code >= 0x2000 && code <= 0x200A) || code == 0x202F ||
         code == 0x205F || code == 0x3000;
}

bool HasNoWidth(char32_t code) { return code == 0x200B || code == 0x2060 || code == 0xFEFF; }

}  // namespace

std::string WithPlainSpaces(std::string_view text) {
  std::string plain;
  plain.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const std::string_view sequence = text.substr(i, LengthOf(text[i]));
    const char32_t code = CodePoint(sequence);
    if (IsSpace(code)) {
      plain += ' ';
    } else if (!HasNoWidth(code)) {
      plain += sequence;
    }
    i += sequence.size();
  }
  return plain;
}

std::string NonAsciiIn(std::string_view text) {
  const auto other =
      std::ranges::find_if(text, [](char c) { return static_cast<unsigned char>(c) >= 0x80U; });
  if (other == text.end()) return {};
  const std::string_view sequence =
      text.substr(static_cast<std::size_t>(other - text.begin()), LengthOf(*other));
  return fmt::format(" with U+{:04X}", static_cast<unsigned>(CodePoint(sequence)));
}

}  // namespace strainwave::schedules
