// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "daq/acquisition/clock_model.h"
#include "daq/acquisition/gap_ledger.h"
#include "daq/acquisition/stream_recorder.h"

namespace strainwave::bench {

/// What is known of a source of samples by now, since it was connected.
struct SourceTotals {
  std::string name;  // of the device in the bench file
  daq::acquisition::GapTotals samples;
  std::optional<daq::acquisition::ClockEstimate>
      clock;  // its clock against the monotonic one of this machine
  std::uint64_t clock_restarts{};
  std::string trouble{};  // in words, while it lasts
};

/// Raw streams that are to be kept while a phase runs, in files NAME-SOURCE-000001.h5 (daq/FORMAT.md).
struct RecordingRequest {
  std::vector<std::string> sources;  // devices of the bench file
  std::filesystem::path folder;      // there already
  std::string name;
  daq::Attributes attributes;  // of every file
};

struct RecordedSource {
  std::string name;
  daq::acquisition::RecorderTotals totals;
  std::string trouble;  // why writing ended early; empty where it did not
};

}  // namespace strainwave::bench
