// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/campaign/cycle_results.h"
#include "bench/campaign/journal.h"
#include "bench/configuration/bench_description.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// What the analysis of a cycle depends on, from the campaign's own frozen files and calibrations. The same
/// while the campaign runs and at any later recomputation.
CycleContext ContextOf(const Journal& journal, const schedules::Schedule& schedule,
                       const BenchDescription& bench);

/// Results of a cycle in the form in which they are stored.
struct StoredCycle {
  std::vector<Result> results;
  std::vector<std::vector<Result>> repeats;  // cycle 0 only
  std::vector<Calibration> calibrations;     // cycle 0 only
  std::vector<std::string> failed_checks;
};

/// @param cycle  0 is the preparation: blank test and repeats instead of one measurement.
StoredCycle AnalyzeForStore(std::span<const NamedRecord> records, int cycle, const CycleContext& context);

}  // namespace strainwave::bench
