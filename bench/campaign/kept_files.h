// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/campaign/folder.h"
#include "bench/campaign/journal.h"

namespace strainwave::bench {

/// Registers the size and SHA-256 of what a cycle has left beside its records: its picture and raw streams.
/// (The digest of the records is in the cycle's own row.)
/// @throws std::system_error, DatabaseError.
void RegisterFilesOfCycle(const CampaignFolder& folder, Journal& journal, int cycle);

/// The same for everything that a run has left: pictures of cycles, streams, what is kept of faults, bus logs
/// and plots. A file whose size or, for a plot, content has changed is registered anew.
void RegisterFiles(const CampaignFolder& folder, Journal& journal);

}  // namespace strainwave::bench
