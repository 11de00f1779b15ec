// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/checkpoint.h"

#include <array>
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
  std::uint64_t campaign;
  std::int64_t last_phase;
  std::int64_t last_event;
  std::int64_t since_boot_ms;
  std::uint64_t boot;
};
static_assert(std::is_trivially_copyable_v<Header>);
// Bytes of the header of each version; a campaign that was begun with an earlier one goes on. Version 1 did
// not know whether the phase was finished, version 2 not of which campaign it was, version 3 not of which
// boot.
constexpr std::array kHeader_bytes{std::size_t{0}, offsetof(Header, finished), offsetof(Header, campaign),
                                   offsetof(Header, since_boot_ms), sizeof(Header)};
constexpr std::int32_t kVersion = kHeader_bytes.size() - 1;
// Half of what a power cut may cost: a beat that comes a little early is synced all the same.
constexpr std::chrono::milliseconds kSyncInterval{500};

// Simulated at 30 000 times real time, the beats of a cycle would write 2300, a tenth of the cycle's time; a
// kill costs at most 3 min of such a bench's load, which are then simulated again.
constexpr std::chrono::milliseconds kWriteInterval{5};

}  // namespace

CheckpointWriter::CheckpointWriter(const std::filesystem::path& file) : file_(file) {}

bool CheckpointWriter::IsDue(std::chrono::steady_clock::time_point now) const {
  return now - last_write_ >= kWriteInterval;
}

bool CheckpointWriter::Write(const Checkpoint& checkpoint, std::span<const std::byte> machine_memory,
                             std::chrono::steady_clock::time_point now) {
  const Header header{kVersion,
                      checkpoint.cycle,
                      checkpoint.step,
                      checkpoint.repeat,
                      checkpoint.credited_load_s,
                      checkpoint.time_s,
                      checkpoint.written.utc_ms,
                      checkpoint.encoder_offset_rad,
                      checkpoint.finished ? 1 : 0,
                      checkpoint.campaign,
                      checkpoint.journal_end.phase,
                      checkpoint.journal_end.event,
                      checkpoint.written.since_boot_ms,
                      checkpoint.written.boot};
  buffer_.resize(sizeof header + machine_memory.size());
  std::memcpy(buffer_.data(), &header, sizeof header);
  if (!machine_memory.empty()) {
    std::memcpy(buffer_.data() + sizeof header, machine_memory.data(), machine_memory.size());
  }
  file_.Write(buffer_);
  last_write_ = now;
  if (now - last_sync_ < kSyncInterval) return false;
  last_sync_ = now;
  Sync();
  return true;
}

void CheckpointWriter::Sync() { file_.Sync(); }

std::optional<Checkpoint> ReadCheckpoint(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  const auto slot = daq::ReadCheckpoint(file);
  if (!slot || slot->payload.size() < kHeader_bytes[1]) return std::nullopt;
  Header header{};
  std::memcpy(&header.version, slot->payload.data(), sizeof header.version);
  if (header.version < 1 || header.version > kVersion) return std::nullopt;
  const std::size_t header_bytes = kHeader_bytes[static_cast<std::size_t>(header.version)];
  if (slot->payload.size() < header_bytes) return std::nullopt;
  std::memcpy(&header, slot->payload.data(), header_bytes);
  Checkpoint checkpoint;
  checkpoint.cycle = header.cycle;
  checkpoint.step = header.step;
  checkpoint.repeat = header.repeat;
  checkpoint.finished = header.finished != 0;
  checkpoint.credited_load_s = header.credited_load_s;
  checkpoint.time_s = header.time_s;
  checkpoint.written = {header.utc_ms, header.since_boot_ms, header.boot};
  checkpoint.encoder_offset_rad = header.encoder_offset_rad;
  checkpoint.campaign = header.campaign;
  checkpoint.journal_end = {header.last_phase, header.last_event};
  checkpoint.damaged_states = slot->damaged_slots;
  checkpoint.machine_memory.assign(slot->payload.begin() + static_cast<std::ptrdiff_t>(header_bytes),
                                   slot->payload.end());
  return checkpoint;
}

}  // namespace strainwave::bench
