// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/campaign/cycle_steps.h"
#include "bench/campaign/folder.h"
#include "bench/campaign/journal.h"
#include "bench/configuration/bench_description.h"
#include "bench/controller/phase_program.h"
#include "bench/roles/channel_calibration.h"
#include "daq/cycle_file.h"
#include "daq/growing_file.h"

namespace strainwave::bench {

/// The raw records of the cycle under way: in memory, and each finished phase also in a file of its own, so
/// that a kill costs at most the phase that it cut. When the cycle's own file has appeared they are gone.
class CycleRecords {
 public:
  /// @param calibrations  that the devices themselves say of their channels.
  /// @param campaign      Journal::Identity, which the files of unfinished phases carry.
  CycleRecords(const CampaignFolder& folder, const BenchDescription& bench,
               std::vector<ChannelCalibration> calibrations, std::uint64_t campaign)
      : folder_(folder), bench_(bench), calibrations_(std::move(calibrations)), campaign_(campaign) {}

  void Begin(int cycle);
  std::span<const NamedRecord> all() const { return records_; }

  /// Takes what an earlier run has left of a step.
  /// @param phases  of this cycle, from the journal.
  /// @return true when the step is complete and need not be run.
  /// @throws BenchError when a file is of another phase or campaign; daq::RecordError when it is damaged.
  bool TakeFromEarlierRun(const CycleStep& step, int repeat, std::span<const PhaseRow> phases);
  /// What was missing of what it took, in words; each once.
  std::vector<std::string> TakeNotes() { return std::exchange(notes_, {}); }

  /// Keeps the records of an attempt that has ended.
  void Keep(const CycleStep& step, int repeat, int attempt, std::vector<NamedRecord> records);
  /// Writes the new rows of one that is still running, in case the program dies.
  void WriteAhead(const CycleStep& step, int repeat, int attempt, std::vector<NamedRecord> records);

  /// The cycle's own file is on the disk.
  void RemoveUnfinished() const;

 private:
  void Name(const CycleStep& step, int repeat, int attempt, std::vector<NamedRecord>& records) const;
  std::filesystem::path RowsFile(const CycleStep& step, int repeat, int attempt) const;
  daq::CycleFile ReadRows(const std::filesystem::path& file);
  /// What the file of an unfinished phase says it is of.
  daq::Attributes Stamps(const CycleStep& step, int repeat, int attempt) const;

  CampaignFolder folder_;
  const BenchDescription& bench_;
  std::vector<ChannelCalibration> calibrations_;
  std::uint64_t campaign_;
  int cycle_{};
  std::vector<NamedRecord> records_;
  std::optional<daq::GrowingFile> ahead_;  // of the attempt under way
  std::vector<std::string> notes_;
};

}  // namespace strainwave::bench
