// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "bench/campaign/journal.h"

namespace strainwave::bench {

/// Samples of one source over the complete cycles of a campaign.
struct SampleCount {
  double received{};
  double lost{};
};

/// Sums of the results "samples_received_SOURCE" and "samples_lost_SOURCE", by source: those that
/// `KeepSampleTotals` has kept, and the results of the cycles after them.
/// @throws DatabaseError.
std::map<std::string, SampleCount> SamplesOf(const Journal& journal);

/// Keeps the sums up to the last complete cycle in the journal, so that reading them takes as long after
/// 100 000 cycles as after one. Called in the transaction that completes a cycle.
/// @throws DatabaseError.
void KeepSampleTotals(Journal& journal);

}  // namespace strainwave::bench
