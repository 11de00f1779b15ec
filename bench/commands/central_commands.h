// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "bench/commands/commands.h"

namespace strainwave::bench {

/// Of `strainwave central`: what reads the server.
void AddCentralCampaigns(CLI::App& central, Action& action);
void AddCentralPage(CLI::App& central, Action& action);

}  // namespace strainwave::bench
