// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <vector>

#include <fmt/format.h>

#include "analysis/diagnosis/lone_samples.h"
#include "analysis/samples/resolution.h"
#include "bench/records/looks.h"

namespace strainwave::bench {

// Of an axis: a torque may jump within a sample, and its study knows how to tell that from an outlier; a
// position and a velocity go through every value between.
void LookAtOutliers(daq::Record& record) {
  if (record.kind != daq::RecordKind::kMotion) return;
  std::vector<bool> kept(record.rows(), true);
  for (const char* name : {"position_rad", "position_m", "velocity_rad_per_s", "velocity_m_per_s"}) {
    if (record.FindColumn(name) == nullptr) continue;
    const std::vector<double> values = record.CopyAsDoubles(name);
    const std::vector<std::size_t> outliers =
        analysis::diagnosis::FindLoneSamples(values, analysis::samples::QuantisationStep(values));
    if (outliers.empty()) continue;
    for (const std::size_t row : outliers) kept[row] = false;
    NoteAt(record, outliers.front(),
           fmt::format("single samples of {} stand off their neighbours, as no axis moves: {}, the first in "
                       "row {}; their rows are left out",
                       name, outliers.size(), outliers.front() + 1));
  }
  if (!std::ranges::all_of(kept, [](bool keep) { return keep; })) KeepRows(record, kept);
}

}  // namespace strainwave::bench
