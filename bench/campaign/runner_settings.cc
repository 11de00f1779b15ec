// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/runner_settings.h"

#include "analysis/units.h"

namespace strainwave::bench {

RunnerSettings RunnerSettingsOf(const BenchDescription& bench) {
  RunnerSettings settings;
  settings.control_period_s = bench.control_period_s;
  settings.stale_after_s = bench.stale_after_s;
  // A simulated bench on its own clock; a real one keeps its period whatever the disk does.
  settings.own_thread = !bench.simulated;
  settings.input_encoder_step_rad = kTwoPi / static_cast<double>(bench.input_encoder.counts_per_rev);
  return settings;
}

}  // namespace strainwave::bench
