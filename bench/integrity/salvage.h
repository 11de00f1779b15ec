// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "bench/campaign/salvage_note.h"
#include "bench/integrity/campaign_integrity.h"

namespace strainwave::bench {

/// Whether a folder may take what is salvaged: new or empty, neither the campaign nor within it nor around
/// it.
/// @throws BenchError (wrong input).
void DemandPlaceToSalvage(const CampaignFolder& from, const std::filesystem::path& out);

/// Writes what is whole of a campaign as another one, which opens for analysis: whole files, of damaged files
/// of records those that are whole, of a damaged journal the rows that can be read. Damaged texts are copied
/// with
/// ".damaged" at the end of their name. The campaign itself is only read.
/// @param integrity  as `VerifyCampaign` has found it.
/// @returns what was recovered and lost, counted; the new journal holds the same.
/// @throws BenchError as above; std::system_error, DatabaseError where `out` cannot be written.
SalvageNote Salvage(const CampaignFolder& from, const CampaignIntegrity& integrity,
                    const std::filesystem::path& out);

}  // namespace strainwave::bench
