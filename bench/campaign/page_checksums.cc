// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/page_checksums.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <vector>

#include "bench/campaign/sqlite_number.h"
#include "daq/crc32.h"
#include "daq/file_descriptor.h"

namespace strainwave::bench {
namespace {

// Places in the header of an SQLite file, in bytes; its numbers are big-endian.
constexpr std::size_t kReservedAt = 20;
constexpr std::size_t kPageCountAt = 28;
constexpr std::size_t kFreePagesAt = 36;
constexpr std::size_t kUserVersionAt = 60;
constexpr std::size_t kApplicationIdAt = 68;
constexpr std::size_t kDatabaseHeader_bytes = 100;

constexpr std::size_t kContent_bytes = kPage_bytes - kPageChecksum_bytes;
constexpr std::size_t kPagesAtOnce = 64;  // fits the cache of a processor

struct Checksum {
  std::uint32_t crc;
  std::uint32_t complement;
};
static_assert(sizeof(Checksum) == kPageChecksum_bytes);

Checksum ChecksumOf(std::span<const std::byte, kPage_bytes> page, std::uint32_t number) {
  const std::uint32_t crc =
      daq::Crc32(page.first(kContent_bytes), daq::Crc32(std::as_bytes(std::span(&number, 1))));
  return {crc, ~crc};
}

bool IsZero(std::span<const std::byte> bytes) {
  return std::ranges::all_of(bytes, [](std::byte byte) { return byte == std::byte{0}; });
}

class Pages {
 public:
  explicit Pages(const std::filesystem::path& path)
      : path_(path), file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (!file_.is_open()) Throw();
  }

  /// Fewer bytes at the end of the file.
  std::size_t Read(std::span<std::byte> into, std::uint64_t at) const {
    const ssize_t got = ::pread(file_.get(), into.data(), into.size(), static_cast<off_t>(at));
    if (got < 0) Throw();
    return static_cast<std::size_t>(got);
  }

 private:
  [[noreturn]] void Throw() const { throw std::system_error(errno, std::generic_category(), path_.string()); }
  std::filesystem::path path_;
  daq::FileDescriptor file_;
};

}  // namespace

void SealPage(PageBytes page, std::uint32_t number) {
  const Checksum checksum = ChecksumOf(page, number);
  std::memcpy(page.data() + kContent_bytes, &checksum, sizeof checksum);
}

void UnsealPage(PageBytes page) { std::memset(page.data() + kContent_bytes, 0, kPageChecksum_bytes); }

PageState StateOf(std::span<const std::byte, kPage_bytes> page, std::uint32_t number) {
  const Checksum checksum = ChecksumOf(page, number);
  const auto stored = page.last(kPageChecksum_bytes);
  if (std::memcmp(stored.data(), &checksum, sizeof checksum) == 0) return PageState::kSealed;
  if (!IsZero(stored)) return PageState::kDamaged;
  return IsZero(page) ? PageState::kNeverWritten : PageState::kUnsealed;
}

bool HasPageChecksums(std::span<const std::byte> header) {
  return header.size() > kReservedAt && header[kReservedAt] == std::byte{kPageChecksum_bytes};
}

std::optional<PageReport> CheckPages(const std::filesystem::path& file, std::uint32_t application_id,
                                     std::uint32_t version) {
  const Pages pages(file);
  std::array<std::byte, kDatabaseHeader_bytes> header{};
  if (pages.Read(header, 0) < header.size()) return std::nullopt;
  // Either will do, so that no flipped bit makes the file one without checksums.
  const bool says_so = SqliteNumber(header, kApplicationIdAt) == application_id &&
                       SqliteNumber(header, kUserVersionAt) == version;
  if (!HasPageChecksums(header) && !says_so) return std::nullopt;

  PageReport report;
  std::uint32_t never_written = 0;
  std::vector<std::byte> buffer(kPagesAtOnce * kPage_bytes);
  std::uint64_t at = 0;
  while (const std::size_t got = pages.Read(buffer, at)) {
    at += got;
    report.cut = report.cut || got % kPage_bytes != 0;
    for (std::size_t i = 0; i + kPage_bytes <= got; i += kPage_bytes) {
      const std::uint32_t number = ++report.pages;
      const auto state = StateOf(std::span(buffer).subspan(i).first<kPage_bytes>(), number);
      if (state == PageState::kDamaged && report.first_damaged == 0) report.first_damaged = number;
      if (state == PageState::kDamaged) ++report.damaged;
      if (state == PageState::kUnsealed) ++report.unsealed;
      if (state == PageState::kNeverWritten) ++never_written;
    }
  }
  report.cut = report.cut || report.pages < SqliteNumber(header, kPageCountAt) ||
               never_written > SqliteNumber(header, kFreePagesAt);
  return report;
}

}  // namespace strainwave::bench
