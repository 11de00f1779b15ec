// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bench/monitor/alarm.h"
#include "bench/monitor/monitor_result.h"
#include "bench/monitor/window.h"
#include "bench/prediction/exported_model.h"

namespace strainwave::bench {

/// Limits by the name of the output that they watch.
using OutputLimits = std::vector<std::pair<std::string, AlarmLimits>>;

/// Turns windows into results: features, network, alarms. One object a thread.
class WindowJudge {
 public:
  /// @param model  outlives the judge.
  /// @param last_number  of the window before the first one.
  /// @param given  under what the reducer runs, where the stream does not tell it.
  /// @throws std::invalid_argument if a limit is of an output that the model does not have, or of a
  ///   class.
  WindowJudge(ExportedModel& model, const OutputLimits& limits, std::int64_t last_number = 0,
              const OperatingPoint& given = {});

  /// Windows in order of time. Only a window that is good moves an alarm.
  MonitorResult Judge(const VibrationWindow& window);

 private:
  ExportedModel& model_;
  std::vector<AlarmLimits> limits_;  // of each output
  std::vector<AlarmState> alarms_;
  std::int64_t last_number_;
  OperatingPoint given_;
};

}  // namespace strainwave::bench
