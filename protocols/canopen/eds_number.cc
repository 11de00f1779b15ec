// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <utility>

#include "protocols/canopen/eds_file.h"
#include "protocols/canopen/ini_text.h"

namespace strainwave::protocols::canopen {
namespace {

constexpr std::string_view kNodeId = "$nodeid";

std::string_view WithoutBlanks(std::string_view text) {
  while (text.starts_with(' ') || text.starts_with('\t')) text.remove_prefix(1);
  while (text.ends_with(' ') || text.ends_with('\t')) text.remove_suffix(1);
  return text;
}

// `text` in lower case and without blanks.
std::optional<std::int64_t> PlainNumber(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  int base = 10;
  if (text.starts_with("0x")) {
    base = 16;
    text.remove_prefix(2);
  } else if (text.size() > 1 && text.starts_with('0')) {
    base = 8;
    text.remove_prefix(1);
  }
  std::uint64_t magnitude{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), magnitude, base);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  constexpr std::uint64_t kMost = 0x7FFFFFFFFFFFFFFF;
  if (magnitude > kMost + (negative ? 1 : 0)) return std::nullopt;
  return static_cast<std::int64_t>(negative ? 0 - magnitude : magnitude);
}

}  // namespace

std::optional<std::int64_t> EdsNumber(std::string_view text, std::uint8_t node_id) {
  const std::string lower = LowerCase(WithoutBlanks(text));
  std::string_view rest = lower;
  if (rest == kNodeId) return node_id;
  const std::size_t plus = rest.find('+');
  if (plus == std::string_view::npos) return PlainNumber(rest);
  std::string_view first = WithoutBlanks(rest.substr(0, plus));
  std::string_view second = WithoutBlanks(rest.substr(plus + 1));
  // CiA 306 has the node first, many an editor of these files the number.
  if (second == kNodeId) std::swap(first, second);
  if (first != kNodeId) return std::nullopt;
  const std::optional<std::int64_t> offset = PlainNumber(second);
  constexpr std::int64_t kMostCobId = 0xFFFFFFFF;
  if (!offset || *offset < 0 || *offset > kMostCobId) return std::nullopt;
  return *offset + node_id;
}

}  // namespace strainwave::protocols::canopen
