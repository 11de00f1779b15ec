// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/commands/commands.h"

namespace strainwave::bench {

/// Commands below `strainwave bench` that move a shaft.
void AddBenchJog(CLI::App& bench, Action& action);
void AddBenchCommission(CLI::App& bench, Action& action);
void AddBenchTripTest(CLI::App& bench, Action& action);

}  // namespace strainwave::bench
