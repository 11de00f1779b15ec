// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/campaign/folder.h"

namespace strainwave::bench {

/// The ways to end a campaign that another process runs, from the softest to the hardest.
enum class EndRequest { kPause, kFinishCycle, kShutdown, kQuickStop };

/// Asks the process that runs the campaign, by a signal: nothing is written, so that a full disk does not
/// matter.
/// @return its id; 0: nobody runs the campaign.
/// @throws std::system_error when that process may not be asked.
int AskToEnd(const CampaignFolder& folder, EndRequest request);

}  // namespace strainwave::bench
