// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>

#include "daq/acquisition/sources/replay_source.h"
#include "daq/record_error.h"

/// A file that stands on no disk.
class FileInMemory {
 public:
  explicit FileInMemory(std::span<const std::byte> bytes) : descriptor_(::memfd_create("fuzz", 0)) {
    if (::write(descriptor_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) std::abort();
  }
  FileInMemory(const FileInMemory&) = delete;
  FileInMemory& operator=(const FileInMemory&) = delete;
  ~FileInMemory() { ::close(descriptor_); }

  std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

/// Replays a file to its end. Either it is refused in words, or its blocks fit into what its description
/// says; those of a record also hold something, and come one after the other in count and time.
inline void ReplayToTheEnd(const std::filesystem::path& path, std::uint32_t samples_a_block, bool is_record) {
  using namespace strainwave::daq::acquisition;
  ReplaySource source({.path = path, .samples_a_block = samples_a_block});
  try {
    source.Start();
    const SourceDescription& description = source.description();
    SampleBlock block(description.channels.size() * description.most_samples_a_block);
    std::uint64_t next = 0;
    std::chrono::nanoseconds arrival{};
    while (source.Next(block, std::chrono::nanoseconds(0)) == NextResult::kBlock) {
      const BlockHeader& header = block.header;
      if (block.words().size() != description.channels.size() * header.samples) std::abort();
      if (!is_record) continue;
      if (header.samples == 0 || header.first_sample < next || header.arrival < arrival) std::abort();
      next = header.first_sample + header.samples;
      arrival = header.arrival;
    }
  } catch (const strainwave::daq::RecordError&) {
  }
}
