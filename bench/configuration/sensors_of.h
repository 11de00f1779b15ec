// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bench/configuration/bench_description.h"
#include "bench/roles/bench_sensors.h"
#include "bench/roles/sampler.h"

namespace strainwave::bench {

BenchSensors SensorsOf(const BenchDescription& bench);

/// What a channel comes from, for people: "torque transducer TT-0815", "device thermometers".
std::string SensorOf(Channel channel, const BenchDescription& bench);

}  // namespace strainwave::bench
