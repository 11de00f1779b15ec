// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/prometheus_text.h"

#include <cstddef>
#include <string_view>

#include <fmt/format.h>

namespace strainwave::bench {
namespace {

void Head(std::string& text, std::string_view name, std::string_view type, std::string_view help) {
  text += fmt::format("# HELP {} {}\n# TYPE {} {}\n", name, help, name, type);
}

void Single(std::string& text, std::string_view name, std::string_view type, std::string_view help,
            auto value) {
  Head(text, name, type, help);
  text += fmt::format("{} {}\n", name, value);
}

void PerOutput(std::string& text, const MonitorFrame& frame, std::string_view name, std::string_view help,
               auto value_of) {
  Head(text, name, "gauge", help);
  for (std::size_t i = 0; i < frame.outputs.size(); ++i) {
    text += fmt::format("{}{{output=\"{}\"}} {}\n", name, frame.outputs[i], value_of(i));
  }
}

}  // namespace

std::string PrometheusText(const MonitorState& state, const MonitorFrame& frame, std::int64_t now_ms) {
  const ValueStatus status = StatusOf(state, frame, now_ms);
  std::string text;
  if (status == ValueStatus::kGood && frame.classes) {
    const std::size_t likeliest = LikeliestOf(state.last->outputs);
    PerOutput(text, frame, "strainwave_class", "1 for the likeliest class.",
              [&](std::size_t i) { return static_cast<int>(i == likeliest); });
    PerOutput(text, frame, "strainwave_class_probability", "Probability of each class; not calibrated.",
              [&](std::size_t i) { return state.last->outputs[i].value; });
  } else if (status == ValueStatus::kGood) {
    const auto& outputs = state.last->outputs;
    PerOutput(text, frame, "strainwave_predicted", "Prediction in the unit that the output's name ends in.",
              [&](std::size_t i) { return outputs[i].value; });
    PerOutput(text, frame, "strainwave_predicted_low", "Lower end of the interval.",
              [&](std::size_t i) { return outputs[i].low; });
    PerOutput(text, frame, "strainwave_predicted_high", "Upper end of the interval.",
              [&](std::size_t i) { return outputs[i].high; });
  }
  if (status == ValueStatus::kGood || status == ValueStatus::kOutsideTraining) {
    Single(text, "strainwave_distance", "gauge", "Distance from the training; above 1 is outside.",
           state.last->distance);
  }
  Head(text, "strainwave_status", "gauge", "1 for what the newest window is.");
  for (const auto each : {ValueStatus::kNone, ValueStatus::kGood, ValueStatus::kBad, ValueStatus::kStale,
                          ValueStatus::kOutsideTraining}) {
    text += fmt::format("strainwave_status{{status=\"{}\"}} {:d}\n", NameOf(each), each == status);
  }
  Single(text, "strainwave_stale", "gauge", "1 when the newest window is older than allowed.",
         static_cast<int>(status == ValueStatus::kStale));
  Single(text, "strainwave_outside_training", "gauge", "1 when the newest window is unlike the training.",
         static_cast<int>(status == ValueStatus::kOutsideTraining));
  if (state.last && !frame.classes) {
    PerOutput(text, frame, "strainwave_alarm", "0 ok, 1 warning, 2 alarm.",
              [&](std::size_t i) { return static_cast<int>(state.last->alarms[i]); });
  }
  if (state.last) {
    Single(text, "strainwave_window_end_timestamp_seconds", "gauge", "End of the newest window.",
           static_cast<double>(state.last->end_ms) / 1000.0);
  }
  Head(text, "strainwave_windows_total", "counter", "Windows by what they came to.");
  text += fmt::format(
      "strainwave_windows_total{{status=\"good\"}} {}\n"
      "strainwave_windows_total{{status=\"bad\"}} {}\n"
      "strainwave_windows_total{{status=\"outside_training\"}} {}\n",
      state.good_windows, state.bad_windows, state.outside_windows);
  if (state.link.used) {
    Single(text, "strainwave_mqtt_connected", "gauge", "1 while the broker has a birth of this node.",
           static_cast<int>(state.link.connected));
    Single(text, "strainwave_outbox_windows", "gauge", "What waits for the broker.",
           state.link.waiting_windows);
    Single(text, "strainwave_outbox_bytes", "gauge", "Memory that it takes.", state.link.waiting_bytes);
    Single(text, "strainwave_dropped_windows_total", "counter", "What no longer found room there.",
           state.link.dropped_windows);
  }
  return text;
}

}  // namespace strainwave::bench
