// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/cycle_records.h"

#include <filesystem>

#include <fmt/core.h>

#include "bench/campaign/sensor_stamps.h"
#include "bench/errors/bench_error.h"
#include "daq/cycle_file.h"

namespace strainwave::bench {

void CycleRecords::Begin(int cycle) {
  cycle_ = cycle;
  records_.clear();
}

bool CycleRecords::TakeFromEarlierRun(const CycleStep& step, int repeat, std::span<const PhaseRow> phases) {
  bool complete = false;
  for (const PhaseRow& row : phases) {
    if (row.step != step.index || row.repeat != repeat) continue;
    complete = complete || row.outcome == "complete";
    const auto file = folder_.UnfinishedFile(cycle_, step.index, repeat, row.attempt);
    const auto rows_file = RowsFile(step, repeat, row.attempt);
    const bool ended = std::filesystem::exists(file);
    if (!ended && !std::filesystem::exists(rows_file)) continue;
    // Of a load run every row counts, of anything else the attempt that was completed.
    if (!step.accumulates && row.outcome != "complete") continue;
    daq::CycleFile kept = ended ? daq::ReadCycleFile(file, daq::Checking::kNone) : ReadRows(rows_file);
    // Those of earlier versions say nothing.
    if (!kept.attributes.empty() && kept.attributes != Stamps(step, repeat, row.attempt)) {
      Refuse(ended ? file : rows_file, "the records are of another phase or campaign",
             fmt::format("those of '{}', attempt {}, of this campaign's cycle {}", step.group, row.attempt,
                         cycle_));
    }
    for (NamedRecord& named : kept.records) {
      named.group.erase(0, named.group.find_first_not_of('/'));
      records_.push_back(std::move(named));
    }
  }
  return complete;
}

void CycleRecords::Name(const CycleStep& step, int repeat, int attempt,
                        std::vector<NamedRecord>& records) const {
  const std::string group = repeat == 0 ? step.group : fmt::format("{}/retry_{}", step.group, repeat);
  for (NamedRecord& named : records) {
    named.group = fmt::format("{}/{}", group, named.group);
    // A load run in several pieces keeps them all, side by side.
    if (step.accumulates && attempt > 1) named.group += fmt::format("_{}", attempt);
  }
  StampSensors(records, bench_, calibrations_);
}

daq::Attributes CycleRecords::Stamps(const CycleStep& step, int repeat, int attempt) const {
  return {{"campaign", fmt::format("{:016x}", campaign_)},
          {"cycle", std::to_string(cycle_)},
          {"step", std::to_string(step.index)},
          {"repeat", std::to_string(repeat)},
          {"attempt", std::to_string(attempt)}};
}

std::filesystem::path CycleRecords::RowsFile(const CycleStep& step, int repeat, int attempt) const {
  return folder_.UnfinishedFile(cycle_, step.index, repeat, attempt).replace_extension(".rows");
}

daq::CycleFile CycleRecords::ReadRows(const std::filesystem::path& file) {
  daq::GrownFile grown = daq::ReadGrowingFile(file);
  if (grown.lost_bytes > 0) {
    notes_.push_back(fmt::format("{}: the last {} bytes are no whole block; their rows are lost",
                                 file.string(), grown.lost_bytes));
  }
  return {std::move(grown.attributes), std::move(grown.records)};
}

void CycleRecords::WriteAhead(const CycleStep& step, int repeat, int attempt,
                              std::vector<NamedRecord> records) {
  if (records.empty()) return;
  Name(step, repeat, attempt, records);
  if (!ahead_) ahead_.emplace(RowsFile(step, repeat, attempt), Stamps(step, repeat, attempt));
  ahead_->Append(records);
}

void CycleRecords::Keep(const CycleStep& step, int repeat, int attempt, std::vector<NamedRecord> records) {
  if (records.empty()) return;
  Name(step, repeat, attempt, records);
  daq::WriteRecordsAtomically(folder_.UnfinishedFile(cycle_, step.index, repeat, attempt), records,
                              Stamps(step, repeat, attempt));
  ahead_.reset();
  std::filesystem::remove(RowsFile(step, repeat, attempt));
  for (NamedRecord& named : records) records_.push_back(std::move(named));
}

void CycleRecords::RemoveUnfinished() const {
  for (const auto& entry : std::filesystem::directory_iterator(folder_.Unfinished())) {
    std::filesystem::remove(entry.path());
  }
}

}  // namespace strainwave::bench
