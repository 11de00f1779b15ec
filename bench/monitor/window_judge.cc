// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/window_judge.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace strainwave::bench {
namespace {

constexpr std::int64_t kNanosecondsPerMillisecond = 1'000'000;
constexpr double kSecondsPerMinute = 60.0;

std::vector<MonitoredOutput> OutputsOf(const PredictedOutputs& predicted) {
  std::vector<MonitoredOutput> outputs;
  for (std::size_t i = 0; i < predicted.value.size(); ++i) {
    const double value = predicted.value[i];
    outputs.push_back({value, value - predicted.half_width[i], value + predicted.half_width[i]});
  }
  return outputs;
}

}  // namespace

WindowJudge::WindowJudge(ExportedModel& model, const OutputLimits& limits, std::int64_t last_number,
                         const OperatingPoint& given)
    : model_(model),
      limits_(model.outputs().size()),
      alarms_(model.outputs().size()),
      last_number_(last_number),
      given_(given) {
  if (model.classes() && !limits.empty()) {
    throw std::invalid_argument(fmt::format(
        "a threshold is for '{}' (expected none: the predictor tells classes)", limits.front().first));
  }
  for (const auto& [output, limit] : limits) {
    const auto found = std::ranges::find(model.outputs(), output);
    if (found == model.outputs().end()) {
      throw std::invalid_argument(fmt::format("a threshold is for '{}' (expected one of the outputs {})",
                                              output, fmt::join(model.outputs(), ", ")));
    }
    limits_[static_cast<std::size_t>(found - model.outputs().begin())] = limit;
  }
}

MonitorResult WindowJudge::Judge(const VibrationWindow& window) {
  MonitorResult result{.number = ++last_number_,
                       .begin_ms = window.begin_ns / kNanosecondsPerMillisecond,
                       .end_ms = window.end_ns / kNanosecondsPerMillisecond,
                       .origin = window.origin,
                       .fault = window.fault,
                       .left = {},
                       .not_known = {},
                       .outputs = {},
                       .alarms = {}};
  if (!result.fault) {
    std::vector<NamedSignal> signals;
    for (std::size_t k = 0; k < window.channels.size(); ++k) {
      signals.push_back({window.channels[k], window.samples[k]});
    }
    OperatingPoint own = OperatingPointOf(signals);
    if (window.samples_per_turn)
      own[OperatingQuantity::kInputSpeed] =
          window.sample_rate_hz * kSecondsPerMinute / *window.samples_per_turn;
    const OperatingPoint operating = Completed(own, given_);
    const auto predicted = model_.Predict(signals, window.sample_rate_hz, window.samples_per_turn, operating);
    if (const auto* fault = std::get_if<SignalFault>(&predicted)) {
      result.fault = *fault;
    } else {
      const auto& outputs = std::get<PredictedOutputs>(predicted);
      result.outputs = OutputsOf(outputs);
      result.distance = outputs.distance;
      result.outside_training = outputs.outside_training();
      result.left = outputs.left;
      result.not_known = model_.NotKnown(operating);
      std::ranges::move(Contradictions(own, given_), std::back_inserter(result.not_known));
    }
  }
  for (std::size_t i = 0; i < alarms_.size(); ++i) {
    if (!result.fault && !result.outside_training) {
      alarms_[i] = Next(alarms_[i], limits_[i], result.outputs[i].value, result.end_ms);
    }
    result.alarms.push_back(alarms_[i].level());
    result.alarm = std::max(result.alarm, result.alarms.back());
  }
  return result;
}

}  // namespace strainwave::bench
