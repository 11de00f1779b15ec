// SPDX-License-Identifier: Apache-2.0
#include "bench/records/look_at_samples.h"

#include <algorithm>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "bench/records/looks.h"
#include "bench/records/sweep_checks.h"
#include "bench/records/vibration_channels.h"

namespace strainwave::bench {

void NoteAt(daq::Record& record, std::size_t row, std::string text) {
  const int first = record.source.first_data_line;
  record.notes.push_back({first > 0 ? first + static_cast<int>(row) : 0, std::move(text)});
}

void NoteOn(daq::Record& record, std::string text) { record.notes.push_back({0, std::move(text)}); }

void KeepRows(daq::Record& record, const std::vector<bool>& kept) {
  for (daq::Column& column : record.columns) {
    std::visit(
        [&kept](auto& values) {
          std::size_t next = 0;
          for (std::size_t i = 0; i < values.size(); ++i) {
            if (kept[i]) values[next++] = values[i];
          }
          values.resize(next);
        },
        column.values);
  }
}

// What has the stamp of the row before and all of its values was written twice.
void LookAtRepeatedRows(daq::Record& record) {
  if (record.FindColumn("time_s") == nullptr) return;
  std::vector<bool> kept(record.rows(), true);
  for (std::size_t i = 1; i < kept.size(); ++i) {
    kept[i] = !std::ranges::all_of(record.columns, [i](const daq::Column& column) {
      return std::visit([i](const auto& values) { return values[i] == values[i - 1]; }, column.values);
    });
  }
  const auto first = std::ranges::find(kept, false);
  if (first == kept.end()) return;
  const std::vector<double> time_s = record.CopyAsDoubles("time_s");
  for (std::size_t i = 1; i < kept.size(); ++i) {
    // Stamps too coarse for the rows say nothing of who repeats what.
    if (kept[i] && time_s[i] == time_s[i - 1]) return;
  }
  NoteAt(record, static_cast<std::size_t>(first - kept.begin()),
         fmt::format("{} rows repeat the one before, with its time: each counts once",
                     std::ranges::count(kept, false)));
  KeepRows(record, kept);
}

void LookAtSamples(daq::Record& record) {
  LookAtRepeatedRows(record);
  LookAtTime(record);
  LookAtAngles(record);
  LookAtStandstill(record);
  LookAtOutliers(record);
  LookAtSteps(record);
  LookAtVelocity(record);
  if (record.kind == daq::RecordKind::kTransmissionError) CheckSweep(record);
  if (record.kind != daq::RecordKind::kVibration) return;
  LookAtRunning(record);
  for (auto& [column, warning] : SortVibrationColumns(record).warnings) NoteOn(record, std::move(warning));
}

}  // namespace strainwave::bench
