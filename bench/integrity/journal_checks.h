// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/integrity/campaign_integrity.h"

namespace strainwave::bench {

/// Every page of the journal against its checksum, the write-ahead log, SQLite's own check, the chain.
/// @throws BenchError (wrong input) for a file that is no journal of a campaign, or of a newer version.
JournalIntegrity CheckJournal(const CampaignFolder& folder);

}  // namespace strainwave::bench
