// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocols/can_frame.h"
#include "protocols/canopen/object.h"

namespace strainwave::protocols::canopen {

/// One object in a PDO.
struct PdoEntry {
  ObjectAddress address;
  std::uint8_t bits{};

  bool operator==(const PdoEntry&) const = default;
};

/// The entry as a mapping object holds it: index, sub-index, bits (CiA 301, 7.5.2.36).
constexpr std::uint32_t MappingValue(const PdoEntry& entry) noexcept {
  return std::uint32_t{entry.address.index} << 16 | std::uint32_t{entry.address.subindex} << 8 | entry.bits;
}
constexpr PdoEntry EntryOfMappingValue(std::uint32_t value) noexcept {
  return {{static_cast<std::uint16_t>(value >> 16), static_cast<std::uint8_t>(value >> 8)},
          static_cast<std::uint8_t>(value)};
}

/// Bits of all entries; a PDO holds 64.
unsigned PdoBits(std::span<const PdoEntry> entries) noexcept;

/// Lays the values one after another from bit 0 of byte 0 on, each cut to its bits (CiA 301, 7.2.2); the
/// frame is as long as the mapping. Nothing if the counts differ or the mapping is above 64 bits.
std::optional<CanFrame> PackPdo(std::uint32_t cob_id, std::span<const PdoEntry> entries,
                                std::span<const std::int64_t> values) noexcept;

/// The bits of entry `which`, without sign; nothing if the frame is not exactly as long as the mapping.
std::optional<std::uint64_t> PdoValue(const CanFrame& frame, std::span<const PdoEntry> entries,
                                      std::size_t which) noexcept;

/// The lowest `bits` of a value as a two's complement number.
std::int64_t SignExtended(std::uint64_t value, unsigned bits) noexcept;

enum class PdoFlow : std::uint8_t { kToDrive, kFromDrive };

/// One PDO as it shall be, named from the drive: what the master sends is the drive's RPDO.
struct PdoSetting {
  PdoFlow flow{};
  std::uint16_t number{};            // 1 to 512: communication object 1400h or 1800h + number - 1
  std::uint32_t cob_id{};            // 11 bits
  std::uint8_t transmission_type{};  // 0 to 240 with SYNC, 254 and 255 by event
  std::optional<std::uint16_t> inhibit_time_100us;
  std::optional<std::uint16_t> event_timer_ms;  // of an RPDO: the time after which the drive misses it
  std::vector<PdoEntry> entries;
};

std::uint16_t CommunicationIndex(const PdoSetting& pdo) noexcept;
std::uint16_t MappingIndex(const PdoSetting& pdo) noexcept;

/// One write of a remap, as data. The value to write is what the object holds now, cut to `keep`, together
/// with `value`.
struct PdoWrite {
  ObjectAddress address;
  std::uint8_t bytes{};
  std::uint32_t value{};
  std::uint32_t keep{};

  bool operator==(const PdoWrite&) const = default;
};

/// The only order in which CiA 301 (7.5.2.36) lets a PDO be mapped anew: not valid (bit 31), no entries, the
/// entries, their number, transmission type and times, valid again; bit 30 of the COB-ID stays as it was.
/// @throws std::invalid_argument for a number, COB-ID or mapping that no PDO can have.
std::vector<PdoWrite> RemapWrites(const PdoSetting& pdo);

/// What has to be read back afterwards: `(read & ~keep) == value`, in the same form.
std::vector<PdoWrite> RemapReadBack(const PdoSetting& pdo);

}  // namespace strainwave::protocols::canopen
