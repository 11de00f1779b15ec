// SPDX-License-Identifier: Apache-2.0
#include "daq/checkpoint_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

#include "daq/crc32.h"
#include "daq/data_file_error.h"
#include "daq/whole_file.h"

namespace strainwave::daq {
namespace {

static_assert(std::endian::native == std::endian::little, "slots are written in the machine's byte order");

constexpr std::size_t kFile_bytes = CheckpointFile::kSlots * CheckpointFile::kSlotStride_bytes;
constexpr char kCheckpointMagic[8] = {'s', 'w', 'c', 'h', 'e', 'c', 'k', '1'};

// The checksum stands last, so that it covers everything before it, and then the payload.
struct SlotHeader {
  char magic[8];
  std::uint64_t sequence;
  std::uint64_t payload_bytes;
  std::uint32_t reserved;
  std::uint32_t crc32;
};
static_assert(sizeof(SlotHeader) == CheckpointFile::kHeader_bytes);

using SlotBytes = std::span<const std::byte, CheckpointFile::kSlotStride_bytes>;

std::uint32_t ChecksumOf(std::span<const std::byte> slot, std::size_t payload_bytes) {
  const std::uint32_t of_header = Crc32(slot.first(offsetof(SlotHeader, crc32)));
  return Crc32(slot.subspan(sizeof(SlotHeader), payload_bytes), of_header);
}

std::optional<SlotHeader> GoodHeader(SlotBytes slot) {
  SlotHeader header;
  std::memcpy(&header, slot.data(), sizeof header);
  const bool good = std::memcmp(header.magic, kCheckpointMagic, sizeof kCheckpointMagic) == 0 &&
                    header.sequence > 0 && header.payload_bytes <= CheckpointFile::kCapacity_bytes &&
                    header.crc32 == ChecksumOf(slot, header.payload_bytes);
  return good ? std::optional(header) : std::nullopt;
}

bool IsUntouched(SlotBytes slot) {
  return std::all_of(slot.begin(), slot.end(), [](std::byte byte) { return byte == std::byte{0}; });
}

[[noreturn]] void ThrowNotACheckpoint(const std::string& why, const std::filesystem::path& path) {
  throw DataFileError(std::make_error_code(std::errc::bad_message), why, path.string());
}

struct Slots {
  std::optional<Checkpoint> newest;
  std::size_t newest_slot{};
  bool all_lost{};  // something was written, and none of it is good
};

Slots ReadSlots(int fd, const std::filesystem::path& path) {
  std::vector<std::byte> bytes(kFile_bytes);
  const ssize_t got = ::pread(fd, bytes.data(), bytes.size(), 0);
  if (got < 0) throw DataFileError(LastError(), "cannot read the checkpoint", path.string());
  struct stat status {};
  if (::fstat(fd, &status) != 0)
    throw DataFileError(LastError(), "cannot read the checkpoint", path.string());
  if (static_cast<std::size_t>(got) != kFile_bytes ||
      static_cast<std::size_t>(status.st_size) != kFile_bytes) {
    ThrowNotACheckpoint(
        fmt::format("not a checkpoint of {} bytes but one of {}:", kFile_bytes, status.st_size), path);
  }
  Slots slots;
  int damaged = 0;
  for (std::size_t i = 0; i < CheckpointFile::kSlots; ++i) {
    const SlotBytes slot(bytes.data() + i * CheckpointFile::kSlotStride_bytes,
                         CheckpointFile::kSlotStride_bytes);
    const std::optional<SlotHeader> header = GoodHeader(slot);
    if (!header) {
      damaged += IsUntouched(slot) ? 0 : 1;
    } else if (!slots.newest || header->sequence > slots.newest->sequence) {
      const auto payload = slot.subspan(sizeof(SlotHeader), header->payload_bytes);
      slots.newest = Checkpoint{header->sequence, {payload.begin(), payload.end()}, 0};
      slots.newest_slot = i;
    }
  }
  if (slots.newest) slots.newest->damaged_slots = damaged;
  slots.all_lost = !slots.newest && damaged > 0;
  return slots;
}

Slots DemandSlots(int fd, const std::filesystem::path& path) {
  // A reader beside a writer can meet a slot half written each time; three in a row is damage.
  for (int attempt = 0; attempt < 3; ++attempt) {
    Slots slots = ReadSlots(fd, path);
    if (!slots.all_lost) return slots;
  }
  ThrowNotACheckpoint("no good slot in the checkpoint", path);
}

FileDescriptor OpenOrCreate(const std::filesystem::path& path) {
  FileDescriptor file(::open(path.c_str(), O_RDWR | O_CLOEXEC));
  if (!file.is_open() && errno == ENOENT) {
    // Zeros that are written, not a hole, so that the disk cannot be full later.
    WriteFileAtomically(path, std::vector<std::byte>(kFile_bytes));
    file = FileDescriptor(::open(path.c_str(), O_RDWR | O_CLOEXEC));
  }
  if (!file.is_open()) throw DataFileError(LastError(), "cannot open the checkpoint", path.string());
  return file;
}

}  // namespace

CheckpointFile::CheckpointFile(const std::filesystem::path& path) : path_(path), file_(OpenOrCreate(path)) {
  const Slots slots = DemandSlots(file_.get(), path_);
  sequence_ = slots.newest ? slots.newest->sequence : 0;
  newest_slot_ = slots.newest_slot;
  // A state that a process before left in the page cache becomes the one to fall back on.
  if (slots.newest) RenewNewest();
  Sync();
}

// Where a sync of that process failed, the kernel holds for written what is not on the disk: the same bytes
// in the same place, which a cut in between leaves as they are, and it has to write them.
void CheckpointFile::RenewNewest() {
  const auto at = static_cast<off_t>(newest_slot_ * kSlotStride_bytes);
  const ssize_t got = ::pread(file_.get(), buffer_.data(), buffer_.size(), at);
  if (got != static_cast<ssize_t>(buffer_.size()) ||
      ::pwrite(file_.get(), buffer_.data(), buffer_.size(), at) != got) {
    throw DataFileError(LastError(), "cannot write the checkpoint", path_.string());
  }
}

void CheckpointFile::DemandSynced() const {
  if (failed_sync_) throw DataFileError(failed_sync_, "cannot sync the checkpoint", path_.string());
}

void CheckpointFile::Write(std::span<const std::byte> payload) {
  DemandSynced();
  if (payload.size() > kCapacity_bytes) {
    throw std::invalid_argument(
        fmt::format("payload of {} bytes is longer than the {} of a slot", payload.size(), kCapacity_bytes));
  }
  SlotHeader header{
      .magic = {}, .sequence = sequence_ + 1, .payload_bytes = payload.size(), .reserved = 0, .crc32 = 0};
  std::memcpy(header.magic, kCheckpointMagic, sizeof kCheckpointMagic);
  std::memcpy(buffer_.data(), &header, sizeof header);
  if (!payload.empty()) std::memcpy(buffer_.data() + sizeof header, payload.data(), payload.size());
  header.crc32 = ChecksumOf(buffer_, payload.size());
  std::memcpy(buffer_.data(), &header, sizeof header);

  std::size_t slot = 0;
  while (slot == newest_slot_ || slot == synced_slot_) ++slot;
  const std::size_t length = sizeof header + payload.size();
  const ssize_t written =
      ::pwrite(file_.get(), buffer_.data(), length, static_cast<off_t>(slot * kSlotStride_bytes));
  if (written != static_cast<ssize_t>(length)) {
    const std::error_code code = written < 0 ? LastError() : std::make_error_code(std::errc::io_error);
    throw DataFileError(code, "cannot write the checkpoint", path_.string());
  }
  newest_slot_ = slot;
  ++sequence_;
}

void CheckpointFile::Sync() {
  if (!failed_sync_ && ::fdatasync(file_.get()) != 0) failed_sync_ = LastError();
  DemandSynced();
  synced_slot_ = newest_slot_;
}

std::optional<Checkpoint> CheckpointFile::ReadLatest() const {
  return DemandSlots(file_.get(), path_).newest;
}

std::optional<Checkpoint> ReadCheckpoint(const std::filesystem::path& path) {
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) throw DataFileError(LastError(), "cannot open the checkpoint", path.string());
  return DemandSlots(file.get(), path).newest;
}

}  // namespace strainwave::daq
