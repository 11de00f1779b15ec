// SPDX-License-Identifier: Apache-2.0
#include "bench/integrity/write_ahead_log.h"

#include <cstddef>
#include <span>
#include <string>

#include <fmt/core.h>

#include "bench/campaign/sqlite_number.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

// Places in the header of the log and of a frame, in bytes; numbers are big-endian.
constexpr std::size_t kHeader_bytes = 32;
constexpr std::size_t kFrameHeader_bytes = 24;
constexpr std::size_t kPageSizeAt = 8;
constexpr std::size_t kSaltsAt = 16;
constexpr std::size_t kHeaderChecksumAt = 24;
constexpr std::size_t kCommitAt = 4;
constexpr std::size_t kFrameSaltsAt = 8;
constexpr std::size_t kFrameChecksumAt = 16;
constexpr std::uint32_t kMagicLittleEndian = 0x377f0682;
constexpr std::uint32_t kMagicBigEndian = 0x377f0683;

using Bytes = std::span<const std::byte>;

std::uint32_t LittleEndian(Bytes bytes, std::size_t at) { return __builtin_bswap32(SqliteNumber(bytes, at)); }

struct Checksum {
  std::uint32_t first{};
  std::uint32_t second{};
  bool operator==(const Checksum&) const = default;
};

// Of words in the order of bytes that the magic number says, going on from `sum`.
Checksum Add(Checksum sum, Bytes bytes, bool big_endian) {
  const auto word = big_endian ? SqliteNumber : LittleEndian;
  for (std::size_t at = 0; at + 8 <= bytes.size(); at += 8) {
    sum.first += word(bytes, at) + sum.second;
    sum.second += word(bytes, at + 4) + sum.first;
  }
  return sum;
}

Checksum StoredAt(Bytes bytes, std::size_t at) {
  return {SqliteNumber(bytes, at), SqliteNumber(bytes, at + 4)};
}

}  // namespace

LogReport CheckLog(const std::filesystem::path& log) {
  LogReport report;
  if (!std::filesystem::exists(log)) return report;
  const std::string content = daq::ReadWholeFile(log);
  const Bytes bytes = std::as_bytes(std::span(content));
  if (bytes.empty()) return report;
  const std::uint32_t magic = bytes.size() < kHeader_bytes ? 0 : SqliteNumber(bytes, 0);
  const bool big_endian = magic == kMagicBigEndian;
  Checksum sum;
  if (magic == kMagicLittleEndian || big_endian) sum = Add({}, bytes.first(kHeaderChecksumAt), big_endian);
  if (magic == 0 || sum != StoredAt(bytes, kHeaderChecksumAt)) {
    report.damage = "its header does not match its checksum, and all rows in it are lost";
    return report;
  }
  const std::size_t frame_bytes = kFrameHeader_bytes + SqliteNumber(bytes, kPageSizeAt);
  const Checksum salts = StoredAt(bytes, kSaltsAt);
  std::uint64_t whole = 0;
  bool chained = true;
  std::uint64_t number = 0;
  for (std::size_t at = kHeader_bytes; at + frame_bytes <= bytes.size(); at += frame_bytes) {
    ++number;
    const Bytes frame = bytes.subspan(at, frame_bytes);
    const Checksum own = StoredAt(frame, kFrameSaltsAt);
    if (chained) {
      sum = Add(Add(sum, frame.first(kFrameSaltsAt), big_endian), frame.subspan(kFrameHeader_bytes),
                big_endian);
      chained = own == salts && sum == StoredAt(frame, kFrameChecksumAt);
      if (chained) {
        whole = number;
        if (SqliteNumber(frame, kCommitAt) != 0) report.frames = number;
        continue;
      }
    }
    // A log that was begun anew leaves frames of the one before, whose salts are both others.
    if (own.first == salts.first || own.second == salts.second) {
      report.damage = fmt::format(
          "frame {} does not match its checksum, and the rows in it and after it are lost: a bit has "
          "changed, or a "
          "power cut has torn it",
          whole + 1);
      return report;
    }
  }
  return report;
}

}  // namespace strainwave::bench
