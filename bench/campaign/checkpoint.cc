// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/checkpoint.h"

#include <cstddef>
#include <cstring>
#include <type_traits>

namespace strainwave::bench {
namespace {

// As written in front of the machine's memory; native byte order, since a campaign resumes where it ran.
struct Header {
  std::int32_t version;
  std::int32_t cycle;
  std::int32_t step;
  std::int32_t repeat;
  double credited_load_s;
  double time_s;
  std::int64_t utc_ms;
  double encoder_offset_rad;
  std::int64_t finished;
};
static_assert(std::is_trivially_copyable_v<Header>);
constexpr std::int32_t kVersion = 2;
// Version 1 did not know whether the phase was finished; a campaign that was begun with it goes on.
constexpr std::int32_t kVersionWithoutFinished = 1;
constexpr std::size_t kBytesWithoutFinished = offsetof(Header, finished);
constexpr std::chrono::seconds kSyncInterval{1};

}  // namespace

CheckpointWriter::CheckpointWriter(const std::filesystem::path& file) : file_(file) {}

void CheckpointWriter::Write(const Checkpoint& checkpoint, std::span<const std::byte> machine_memory) {
  const Header header{kVersion,
                      checkpoint.cycle,
                      checkpoint.step,
                      checkpoint.repeat,
                      checkpoint.credited_load_s,
                      checkpoint.time_s,
                      checkpoint.utc_ms,
                      checkpoint.encoder_offset_rad,
                      checkpoint.finished ? 1 : 0};
  buffer_.resize(sizeof header + machine_memory.size());
  std::memcpy(buffer_.data(), &header, sizeof header);
  if (!machine_memory.empty()) {
    std::memcpy(buffer_.data() + sizeof header, machine_memory.data(), machine_memory.size());
  }
  file_.Write(buffer_);
  const auto now = std::chrono::steady_clock::now();
  if (now - last_sync_ < kSyncInterval) return;
  last_sync_ = now;
  file_.Sync();
}

void CheckpointWriter::Sync() { file_.Sync(); }

std::optional<Checkpoint> ReadCheckpoint(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  const auto slot = daq::ReadCheckpoint(file);
  if (!slot || slot->payload.size() < kBytesWithoutFinished) return std::nullopt;
  Header header{};
  std::memcpy(&header, slot->payload.data(), kBytesWithoutFinished);
  std::size_t header_bytes = kBytesWithoutFinished;
  if (header.version == kVersion && slot->payload.size() >= sizeof header) {
    header_bytes = sizeof header;
    std::memcpy(&header, slot->payload.data(), header_bytes);
  } else if (header.version != kVersionWithoutFinished) {
    return std::nullopt;
  }
  Checkpoint checkpoint;
  checkpoint.cycle = header.cycle;
  checkpoint.step = header.step;
  checkpoint.repeat = header.repeat;
  checkpoint.finished = header.finished != 0;
  checkpoint.credited_load_s = header.credited_load_s;
  checkpoint.time_s = header.time_s;
  checkpoint.utc_ms = header.utc_ms;
  checkpoint.encoder_offset_rad = header.encoder_offset_rad;
  checkpoint.machine_memory.assign(slot->payload.begin() + static_cast<std::ptrdiff_t>(header_bytes),
                                   slot->payload.end());
  return checkpoint;
}

}  // namespace strainwave::bench
