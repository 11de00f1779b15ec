// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bench/campaign/folder.h"

namespace strainwave::bench {

struct PageOptions {
  bool serves{};
  int port{8080};
  std::string users;  // file; empty: none
};

/// Starts `strainwave serve` as a process of its own, which stays when the run has ended, and says where the
/// page is; what that process says is in `DIR/page.txt`. A campaign without its page is a warning and no
/// more.
void ServeBeside(const CampaignFolder& folder, const PageOptions& options);

}  // namespace strainwave::bench
