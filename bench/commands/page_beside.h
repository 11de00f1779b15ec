// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/campaign/folder.h"
#include "bench/commands/page_options.h"

namespace strainwave::bench {

/// Starts `strainwave serve` as a process of its own, which stays when the run has ended, and says where the
/// page is; what that process says is in `DIR/page.txt`. A campaign without its page is a warning and no
/// more.
void ServeBeside(const CampaignFolder& folder, const PageOptions& options);

}  // namespace strainwave::bench
