// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/configuration/bench_description.h"
#include "bench/controller/phase_runner.h"

namespace strainwave::bench {

/// What a bench asks of the loop that runs on it; limits and suspension are for the caller to add.
RunnerSettings RunnerSettingsOf(const BenchDescription& bench);

}  // namespace strainwave::bench
