// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/pdo.h"

#include <fmt/format.h>

#include <numeric>
#include <stdexcept>

#include "protocols/canopen/wire_bytes.h"

namespace strainwave::protocols::canopen {
namespace {

constexpr unsigned kMostBits = 64;
constexpr std::uint32_t kNotValid = 0x80000000;       // bit 31 of a COB-ID
constexpr std::uint32_t kWithoutRemote = 0x40000000;  // bit 30: the drive's own affair

constexpr std::uint64_t Mask(unsigned bits) {
  return bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
}

void Check(const PdoSetting& pdo) {
  if (pdo.number < 1 || pdo.number > 512) {
    throw std::invalid_argument(fmt::format("number = {} of a PDO is not 1 to 512", pdo.number));
  }
  // Where the predefined connection set has its PDOs; above are SDO and heartbeat, below EMCY and SYNC.
  if (pdo.cob_id < 0x181 || pdo.cob_id > 0x57F) {
    throw std::invalid_argument(fmt::format("cob_id = {:X}h of a PDO is not 181h to 57Fh", pdo.cob_id));
  }
  if (pdo.entries.empty() || pdo.entries.size() > 64) {
    throw std::invalid_argument(
        fmt::format("entries = {} of PDO {:X}h are not 1 to 64", pdo.entries.size(), pdo.cob_id));
  }
  for (const PdoEntry& entry : pdo.entries) {
    if (entry.bits < 1 || entry.bits > kMostBits) {
      throw std::invalid_argument(fmt::format("bits = {} of {:04X}h:{:02X} are not 1 to 64", entry.bits,
                                              entry.address.index, entry.address.subindex));
    }
  }
  if (PdoBits(pdo.entries) > kMostBits) {
    throw std::invalid_argument(
        fmt::format("PDO {:X}h maps {} bits, above 64", pdo.cob_id, PdoBits(pdo.entries)));
  }
}

std::vector<PdoWrite> Parameters(const PdoSetting& pdo) {
  const std::uint16_t index = CommunicationIndex(pdo);
  std::vector<PdoWrite> writes{{{index, 2}, 1, pdo.transmission_type, 0}};
  if (pdo.inhibit_time_100us) writes.push_back({{index, 3}, 2, *pdo.inhibit_time_100us, 0});
  if (pdo.event_timer_ms) writes.push_back({{index, 5}, 2, *pdo.event_timer_ms, 0});
  return writes;
}

std::vector<PdoWrite> Entries(const PdoSetting& pdo) {
  std::vector<PdoWrite> writes;
  for (std::size_t i = 0; i < pdo.entries.size(); ++i) {
    writes.push_back(
        {{MappingIndex(pdo), static_cast<std::uint8_t>(i + 1)}, 4, MappingValue(pdo.entries[i]), 0});
  }
  return writes;
}

PdoWrite Count(const PdoSetting& pdo, std::size_t count) {
  return {{MappingIndex(pdo), 0}, 1, static_cast<std::uint32_t>(count), 0};
}

void Append(std::vector<PdoWrite>& writes, const std::vector<PdoWrite>& more) {
  writes.insert(writes.end(), more.begin(), more.end());
}

}  // namespace

unsigned PdoBits(std::span<const PdoEntry> entries) noexcept {
  return std::accumulate(entries.begin(), entries.end(), 0U,
                         [](unsigned sum, const PdoEntry& entry) { return sum + entry.bits; });
}

std::optional<CanFrame> PackPdo(std::uint32_t cob_id, std::span<const PdoEntry> entries,
                                std::span<const std::int64_t> values) noexcept {
  const unsigned bits = PdoBits(entries);
  if (entries.size() != values.size() || bits > kMostBits) return std::nullopt;
  std::uint64_t packed = 0;
  unsigned at = 0;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (entries[i].bits == 0) continue;
    packed |= (static_cast<std::uint64_t>(values[i]) & Mask(entries[i].bits)) << at;
    at += entries[i].bits;
  }
  CanFrame frame{.id = cob_id, .length = static_cast<std::uint8_t>((bits + 7) / 8)};
  ToLittleEndian(packed, frame.data);
  return frame;
}

std::optional<std::uint64_t> PdoValue(const CanFrame& frame, std::span<const PdoEntry> entries,
                                      std::size_t which) noexcept {
  if (which >= entries.size() || entries[which].bits == 0) return std::nullopt;
  const unsigned bits = PdoBits(entries);
  if (bits > kMostBits || frame.length != (bits + 7) / 8) return std::nullopt;
  const unsigned before = PdoBits(entries.first(which));
  return FromLittleEndian(frame.data) >> before & Mask(entries[which].bits);
}

std::int64_t SignExtended(std::uint64_t value, unsigned bits) noexcept {
  if (bits == 0 || bits >= 64) return static_cast<std::int64_t>(value);
  const std::uint64_t sign = std::uint64_t{1} << (bits - 1);
  return static_cast<std::int64_t>(((value & Mask(bits)) ^ sign) - sign);
}

std::uint16_t CommunicationIndex(const PdoSetting& pdo) noexcept {
  const unsigned base = pdo.flow == PdoFlow::kToDrive ? 0x1400 : 0x1800;
  return static_cast<std::uint16_t>(base + pdo.number - 1U);
}

std::uint16_t MappingIndex(const PdoSetting& pdo) noexcept {
  return static_cast<std::uint16_t>(CommunicationIndex(pdo) + 0x200U);
}

std::vector<PdoWrite> RemapWrites(const PdoSetting& pdo) {
  Check(pdo);
  const ObjectAddress cob_id{CommunicationIndex(pdo), 1};
  // While a PDO is valid none but bit 31 may change, so that the first write keeps all others.
  std::vector<PdoWrite> writes{{cob_id, 4, kNotValid, ~kNotValid}, Count(pdo, 0)};
  Append(writes, Entries(pdo));
  writes.push_back(Count(pdo, pdo.entries.size()));
  Append(writes, Parameters(pdo));
  writes.push_back({cob_id, 4, pdo.cob_id, kWithoutRemote});
  return writes;
}

std::vector<PdoWrite> RemapReadBack(const PdoSetting& pdo) {
  Check(pdo);
  std::vector<PdoWrite> reads{Count(pdo, pdo.entries.size())};
  Append(reads, Entries(pdo));
  Append(reads, Parameters(pdo));
  reads.push_back({{CommunicationIndex(pdo), 1}, 4, pdo.cob_id, kWithoutRemote});
  return reads;
}

}  // namespace strainwave::protocols::canopen
