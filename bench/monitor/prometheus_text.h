// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "bench/monitor/monitor_result.h"

namespace strainwave::bench {

/// What a Prometheus server scrapes, text format 0.0.4. `strainwave_predicted`, `_low` and `_high` with the
/// label `output` are there only while the status is good, `strainwave_distance` also outside the training;
/// the status itself is in `strainwave_status{status="…"} 1`, `strainwave_stale`,
/// `strainwave_outside_training`.
std::string PrometheusText(const MonitorState& state, const MonitorFrame& frame, std::int64_t now_ms);

}  // namespace strainwave::bench
