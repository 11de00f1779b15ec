// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "bench/integrity/campaign_integrity.h"

namespace strainwave::bench {

/// The cycle that a file of a campaign is of, by its name: 12 of "cycles/000012.h5", "streams/000012-…".
std::optional<int> CycleNamed(std::string_view path);

/// Reads a file of a campaign and says what state it is in.
/// @param sha256  as it was registered; empty: its own checksums alone are looked at.
/// @param file    with path and bytes; state, reason and records are filled in.
void CheckFile(const CampaignFolder& folder, const std::string& sha256, FileIntegrity& file);

}  // namespace strainwave::bench
