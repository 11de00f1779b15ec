// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/roles/bench_clock.h"
#include "bench/roles/sampler.h"
#include "bench/roles/servo_drive.h"

namespace strainwave::bench {

/// The devices that a phase drives. They outlive it.
struct BenchDevices {
  ServoDrive& driving;
  ServoDrive& load;  // torque in Nm at the reducer's output
  Sampler& sampler;
  BenchClock& clock;
};

}  // namespace strainwave::bench
