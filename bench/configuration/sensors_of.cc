// SPDX-License-Identifier: Apache-2.0
#include "bench/configuration/sensors_of.h"

#include <algorithm>

namespace strainwave::bench {

BenchSensors SensorsOf(const BenchDescription& bench) {
  return {.vibration = !bench.accelerometers.empty(),
          .quick_stop_key = std::ranges::any_of(bench.devices, [](const DeviceDescription& device) {
            return device.kind == DeviceDescription::Kind::kPendant;
          })};
}

}  // namespace strainwave::bench
