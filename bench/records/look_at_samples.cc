// SPDX-License-Identifier: Apache-2.0
#include "bench/records/look_at_samples.h"

#include <algorithm>
#include <utility>

#include "bench/diagnosis/vibration_channels.h"
#include "bench/records/looks.h"
#include "bench/records/sweep_checks.h"

namespace strainwave::bench {

void NoteAt(daq::Record& record, std::size_t row, std::string text) {
  const int first = record.source.first_data_line;
  record.notes.push_back({first > 0 ? first + static_cast<int>(row) : 0, std::move(text)});
}

void NoteOn(daq::Record& record, std::string text) { record.notes.push_back({0, std::move(text)}); }

void LookAtSamples(daq::Record& record) {
  LookAtTime(record);
  LookAtAngles(record);
  LookAtStandstill(record);
  LookAtSteps(record);
  if (record.kind == "transmission_error") CheckSweep(record);
  if (record.kind != "vibration") return;
  for (auto& [column, warning] : SortVibrationColumns(record).warnings) NoteOn(record, std::move(warning));
}

}  // namespace strainwave::bench
