// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "analysis/quantities.h"
#include "bench/campaign/folder.h"
#include "bench/campaign/journal.h"

namespace strainwave::bench {

/// Results of a campaign on standard output: the table of transmission error and stiffness a cycle, the
/// change from first to last cycle beside the repeatability, and the pictures and paths; or the same as JSON.
/// @return exit code 0.
int PrintCampaign(const CampaignFolder& folder, const Journal& journal, bool json);

/// A number of a table; "–" for what was not measured.
std::string ValueCell(double value, int width, int decimals);

/// "K1 Nm/rad", "e_max '": what stands above a column of its values.
std::string ColumnTitle(const analysis::Quantity& quantity);

/// One cycle as an object: every quantity by its name, `_se` beside it, and why a value is not good in
/// `flags`.
nlohmann::json CycleJson(int cycle, const std::vector<Result>& results);

}  // namespace strainwave::bench
