// SPDX-License-Identifier: Apache-2.0
// Any state in a checkpoint file, whose checksum is right, as each of the files of a campaign that are such:
// where it was, its newest readings, their envelopes, its sources of samples; and any slot.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "bench/campaign/checkpoint.h"
#include "bench/campaign/live_envelope.h"
#include "bench/campaign/live_readings.h"
#include "bench/campaign/live_sources.h"
#include "daq/crc32.h"
#include "daq/data_file_error.h"
#include "tests/fuzz/file_in_memory.h"

namespace {

using strainwave::daq::CheckpointFile;

std::vector<std::byte> FileOf(std::span<const std::uint8_t> payload) {
  std::vector<std::byte> bytes(CheckpointFile::kSlots * CheckpointFile::kSlotStride_bytes);
  payload = payload.first(std::min(payload.size(), CheckpointFile::kCapacity_bytes));
  constexpr std::uint64_t kSequence = 1;
  const std::uint64_t size = payload.size();
  std::memcpy(bytes.data(), "swcheck1", 8);
  std::memcpy(bytes.data() + 8, &kSequence, 8);
  std::memcpy(bytes.data() + 16, &size, 8);
  if (!payload.empty())
    std::memcpy(bytes.data() + CheckpointFile::kHeader_bytes, payload.data(), payload.size());
  const std::span<const std::byte> slot(bytes);
  const std::uint32_t crc =
      strainwave::daq::Crc32(slot.subspan(CheckpointFile::kHeader_bytes, payload.size()),
                             strainwave::daq::Crc32(slot.first(CheckpointFile::kHeader_bytes - 4)));
  std::memcpy(bytes.data() + CheckpointFile::kHeader_bytes - 4, &crc, 4);
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave::bench;
  if (size == 0) return 0;
  const std::span payload(data + 1, size - 1);
  std::vector<std::byte> bytes = FileOf(payload);
  if (data[0] % 8 == 0 && !payload.empty())
    std::memcpy(bytes.data(), payload.data(), std::min<std::size_t>(payload.size(), 64));
  const FileInMemory file(bytes);
  try {
    (void)ReadCheckpoint(file.path());
  } catch (const strainwave::daq::DataFileError&) {
  }
  (void)ReadLiveReadings(file.path());
  (void)ReadLiveSources(file.path());
  std::uint64_t campaign{};
  std::memcpy(&campaign, data, std::min<std::size_t>(size, sizeof campaign));
  for (const std::uint64_t each : {std::uint64_t{0}, campaign}) {
    const auto live = ReadLiveEnvelopes(file.path(), each);
    if (live && (live->recent.bins().size() > LiveEnvelopes::kBins || !(live->whole.width_s() > 0)))
      std::abort();
  }
  return 0;
}
