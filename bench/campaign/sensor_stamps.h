// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "bench/configuration/bench_description.h"
#include "bench/controller/phase_program.h"
#include "bench/roles/channel_calibration.h"

namespace strainwave::bench {

/// Writes into every column which sensor of the bench it came from and under which calibration, with what the
/// device itself says of that, and whether it holds today (docs/contract.md#campaign-folder). Columns without
/// a described sensor, such as time, stay as they are.
void StampSensors(std::span<NamedRecord> records, const BenchDescription& bench,
                  std::span<const ChannelCalibration> of_devices = {});

}  // namespace strainwave::bench
