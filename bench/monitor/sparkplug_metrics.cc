// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/sparkplug_metrics.h"

#include <algorithm>
#include <string>
#include <utility>

namespace strainwave::bench {
namespace {

using protocols::SparkplugMetric;
using protocols::SparkplugQuality;

SparkplugQuality QualityOf(ValueStatus status) {
  switch (status) {
    case ValueStatus::kGood:
      return SparkplugQuality::kGood;
    case ValueStatus::kNone:
    case ValueStatus::kStale:
      return SparkplugQuality::kStale;
    case ValueStatus::kBad:
    case ValueStatus::kOutsideTraining:
      return SparkplugQuality::kBad;
  }
  return SparkplugQuality::kBad;
}

// A file of nothing but mistakes has more to say than a topic should carry: its first line.
std::string QualityText(const MonitorState& state, ValueStatus status) {
  constexpr std::size_t kMostLetters = 300;
  if (status != ValueStatus::kBad) return std::string(NameOf(status));
  const SignalFault& fault = *state.last->fault;
  const std::string text = fault.text.substr(0, std::min(fault.text.find('\n'), kMostLetters));
  return std::string(NameOf(fault.kind)) + ": " + text;
}

}  // namespace

std::vector<SparkplugMetric> SparkplugMetrics(const MonitorState& state, const MonitorFrame& frame,
                                              std::int64_t now_ms) {
  const ValueStatus status = StatusOf(state, frame, now_ms);
  const bool of_window = state.last && status != ValueStatus::kStale;
  const bool has_values = status == ValueStatus::kGood || status == ValueStatus::kOutsideTraining;
  const std::int64_t time_ms = of_window ? state.last->end_ms : now_ms;
  const SparkplugQuality quality = QualityOf(status);
  std::vector<SparkplugMetric> metrics;
  const auto add = [&](std::string name, SparkplugMetric::Value value, bool known,
                       std::optional<SparkplugQuality> of = std::nullopt) {
    metrics.push_back({.name = std::move(name),
                       .value = std::move(value),
                       .time_ms = time_ms,
                       .is_null = !known,
                       .is_historical = false,
                       .quality = of});
  };
  const auto alarm_text = [](AlarmLevel level) { return std::string(NameOf(level)); };
  add(std::string(kWindowMetric), state.last ? state.last->number : std::int64_t{0}, of_window);
  add("Quality", QualityText(state, status), true);
  add("Alarm", alarm_text(state.last ? state.last->alarm : AlarmLevel::kOk), of_window, quality);
  add("Outside training", status == ValueStatus::kOutsideTraining, has_values);
  add("Distance", has_values ? state.last->distance : 0.0, has_values, quality);
  add("Dropped windows", static_cast<std::int64_t>(state.link.dropped_windows), true);
  if (frame.classes) {
    add("Class", has_values ? frame.outputs[LikeliestOf(state.last->outputs)] : std::string(), has_values,
        quality);
    for (std::size_t i = 0; i < frame.outputs.size(); ++i) {
      add(frame.outputs[i] + "/Probability", has_values ? state.last->outputs[i].value : 0.0, has_values,
          quality);
    }
    return metrics;
  }
  for (std::size_t i = 0; i < frame.outputs.size(); ++i) {
    const MonitoredOutput output = has_values ? state.last->outputs[i] : MonitoredOutput{};
    const std::string& name = frame.outputs[i];
    add(name + "/Value", output.value, has_values, quality);
    add(name + "/Low", output.low, has_values, quality);
    add(name + "/High", output.high, has_values, quality);
    add(name + "/Alarm", alarm_text(of_window ? state.last->alarms[i] : AlarmLevel::kOk), of_window, quality);
  }
  return metrics;
}

}  // namespace strainwave::bench
