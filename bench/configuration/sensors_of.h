// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/configuration/bench_description.h"
#include "bench/roles/bench_sensors.h"

namespace strainwave::bench {

BenchSensors SensorsOf(const BenchDescription& bench);

}  // namespace strainwave::bench
