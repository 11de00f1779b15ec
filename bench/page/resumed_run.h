// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bench/campaign/folder.h"
#include "bench/page/actions.h"

namespace strainwave::bench {

/// Goes on with a campaign, as `strainwave run --out DIR --resume` does, in a process of
/// its own that outlives this one and hears no signal of its terminal. What it says is added to
/// `DIR/resumed.txt`. Waits until the run has begun, or the process has ended, for half a minute at most: not
/// for the server's thread.
/// @return 200; or why it did not begin, in the process's own last words.
ActionAnswer ResumeRun(const CampaignFolder& folder, const AskedAction& asked, const std::string& now_utc);

}  // namespace strainwave::bench
