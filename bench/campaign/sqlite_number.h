// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace strainwave::bench {

/// A 4-byte number of SQLite's files, which are big-endian (sqlite.org/fileformat2.html).
/// @param at  of its first byte; at + 4 ≤ bytes.size().
inline std::uint32_t SqliteNumber(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) number = number << 8U | std::to_integer<std::uint32_t>(bytes[at + i]);
  return number;
}

}  // namespace strainwave::bench
