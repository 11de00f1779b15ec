// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

namespace strainwave::bench {

/// Pages of a database whose last bytes hold a checksum of all the others. SQLite's file format leaves such
/// bytes to whoever wants them (sqlite.org/fileformat2.html, "reserved bytes"), so that every SQLite reads
/// the file; one that writes leaves the bytes as it found them.
///
///     page = content, CRC-32 (zlib) of its number (u32, little-endian) and content, complement of that CRC
///
/// Zeros in the place of the checksum: SQLite elsewhere has copied the page out of the write-ahead log, in
/// whose frames there is none (the log has checksums of its own). A page of zeros was never written.
inline constexpr std::size_t kPage_bytes = 4096;
inline constexpr std::size_t kPageChecksum_bytes = 8;

using PageBytes = std::span<std::byte, kPage_bytes>;

enum class PageState { kSealed, kUnsealed, kNeverWritten, kDamaged };

/// @param number  of the page, from 1.
void SealPage(PageBytes page, std::uint32_t number);
/// The page as it stands in a write-ahead log.
void UnsealPage(PageBytes page);
PageState StateOf(std::span<const std::byte, kPage_bytes> page, std::uint32_t number);

/// Whether a database says of itself that its pages hold checksums, by the first bytes of its file.
bool HasPageChecksums(std::span<const std::byte> header);

struct PageReport {
  std::uint32_t pages{};
  std::uint32_t first_damaged{};  // 0: none
  std::uint32_t damaged{};        // all of them
  std::uint32_t unsealed{};
  bool cut{};  // shorter than it says itself
};

/// Looks at every page of the file, as it stands beside its write-ahead log.
/// @param application_id, version  of a database that must hold checksums, whatever else its header says.
/// @returns nothing for one without. @throws std::system_error.
std::optional<PageReport> CheckPages(const std::filesystem::path& file, std::uint32_t application_id,
                                     std::uint32_t version);

}  // namespace strainwave::bench
