// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/report/campaign_sheet.h"

namespace strainwave::bench {

/// Quantities over cycles, three panels a picture, the campaigns in colours of their own. Of a campaign of
/// more than 300 cycles every n-th is drawn, and the last. Of one campaign alone, control limits stand
/// beside its line, and the stop criterion where it is near. Quantities without a trend to look at (times,
/// the encoders' skew) are left out.
/// @return one `<svg>` element a picture. @throws GnuplotError.
std::vector<std::string> DrawTrendPanels(std::span<const CampaignSheet> sheets,
                                         const std::vector<std::string>& quantities);

}  // namespace strainwave::bench
