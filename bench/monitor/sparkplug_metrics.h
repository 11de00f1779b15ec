// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "bench/monitor/monitor_result.h"
#include "protocols/sparkplug.h"

namespace strainwave::bench {

inline constexpr std::string_view kWindowMetric = "Window";

/// All metrics of a monitor, with the values of its newest result and of its link. Values that are not good
/// are null and of quality BAD, old ones null and STALE; outside the training they stand there with quality
/// BAD.
///
///   Window (number of the window), Quality (text: "good", or why not), Alarm (text: the highest),
///   Outside training, Distance, Dropped windows, and for each output
///   OUTPUT/Value, OUTPUT/Low, OUTPUT/High, OUTPUT/Alarm.
///
/// @param now_ms  time of the stream; the metrics carry the end of the window, or `now_ms` where they tell of
///   no window or of one that has gone stale.
std::vector<protocols::SparkplugMetric> SparkplugMetrics(const MonitorState& state, const MonitorFrame& frame,
                                                         std::int64_t now_ms);

}  // namespace strainwave::bench
