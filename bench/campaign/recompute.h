// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/campaign/cycle_context.h"
#include "bench/campaign/folder.h"
#include "bench/campaign/journal.h"

namespace strainwave::bench {

/// One cycle, computed again from its raw records.
struct RecomputedCycle {
  int cycle{};
  double ended_s{};  // bench time
  StoredCycle again;
  std::vector<std::vector<Result>> stored;  // what the journal holds: the cycle, then its repeats
  bool equal{};                             // bit for bit, all quantities, of cycle 0 also the calibrations
};

/// What is stored of a cycle in order: records by their group's name without the leading slash.
/// @throws BenchError when the file is missing, not the one that the journal knows, or of another cycle or
///   campaign; daq::RecordError when it is damaged.
std::vector<NamedRecord> ReadCycleRecords(const CampaignFolder& folder, const Journal& journal, int cycle);

/// Computes every complete cycle of a campaign again, on all processors.
/// @param method    by which the stiffness is measured; only the campaign's own can equal what is stored.
/// @param progress  called with the number of cycles done; may be empty.
/// @throws BenchError with all findings when cycle files are missing or damaged.
std::vector<RecomputedCycle> RecomputeCampaign(const CampaignFolder& folder, const Journal& journal,
                                               const CycleContext& context,
                                               const std::function<void(std::size_t, std::size_t)>& progress);

}  // namespace strainwave::bench
