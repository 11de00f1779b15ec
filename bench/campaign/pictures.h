// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "analysis/torsional_stiffness.h"
#include "bench/campaign/folder.h"
#include "bench/campaign/journal.h"
#include "bench/campaign/record_results.h"
#include "daq/record.h"

namespace strainwave::bench {

/// Hysteresis loop with the fitted K1–K3 and transmission error with its orders, first and last complete
/// cycle, and the trends over all cycles. Each as SVG and PNG.
/// Their names hold campaign, cycles and lock angle.
/// @return the pictures' paths without ending.
std::vector<std::filesystem::path> DrawCampaign(const CampaignFolder& folder, const Journal& journal,
                                                const std::filesystem::path& into);

/// The picture of one record, named after its file (of a campaign's the campaign and the cycle), its group or
/// kind, and its lock angle.
std::vector<std::filesystem::path> DrawRecord(const daq::Record& record, analysis::StiffnessMethod method,
                                              const BenchCorrections& corrections,
                                              const std::filesystem::path& into);

}  // namespace strainwave::bench
