// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "bench/configuration/bench_description.h"
#include "bench/controller/phase_program.h"

namespace strainwave::bench {

/// Writes into every column which sensor of the bench it came from and under which calibration (contract,
/// section 5). Columns without a described sensor, such as time, stay as they are.
void StampSensors(std::span<NamedRecord> records, const BenchDescription& bench);

}  // namespace strainwave::bench
