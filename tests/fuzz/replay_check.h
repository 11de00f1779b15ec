// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>

#include "daq/acquisition/sources/replay_source.h"
#include "daq/record_error.h"
#include "tests/fuzz/file_in_memory.h"

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
