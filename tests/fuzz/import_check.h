// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>

#include "daq/import/foreign_file.h"
#include "daq/import/record_map.h"
#include "daq/record_error.h"
#include "tests/fuzz/file_in_memory.h"

/// Reads the bytes as a file of others, shows it and makes a record of it: either it is refused in words, or
/// each of its series has a name of its own, and values or words.
inline void ReadAndMap(std::span<const std::byte> bytes,
                       strainwave::daq::ForeignFile (*read)(const std::filesystem::path&)) {
  using namespace strainwave::daq;
  const FileInMemory memory(bytes);
  try {
    ForeignFile file = read(memory.path());
    MakeNamesUnique(file);
    for (const ForeignChannel& channel : file.channels) {
      if (channel.name.empty() && file.channels.size() > 1) std::abort();
      if (!channel.values.empty() && !channel.words.empty()) std::abort();
    }
    (void)PreviewOf(file);
    RecordMap map = OwnNames(file).value_or(RecordMap{.kind = RecordKind::kVibration});
    if (map.columns.empty() && !file.channels.empty()) {
      map.sample_rate_hz = 1000.0;
      map.columns.push_back(
          {.column = "accel_x_m_per_s2", .source = {file.channels.front().name, std::nullopt, "map"}});
    }
    (void)MapRecord(file, map, "file");
  } catch (const RecordError&) {
  }
}
