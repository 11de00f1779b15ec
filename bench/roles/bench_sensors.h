// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace strainwave::bench {

/// What a bench may be without. Angles, torque and the gear's temperature every bench has.
struct BenchSensors {
  bool vibration{};
  bool quick_stop_key{};
};

}  // namespace strainwave::bench
