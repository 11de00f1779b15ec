// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/signal_inputs.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/campaign/campaign_error.h"

namespace strainwave::bench {
namespace {

constexpr double kRateTolerance = 0.01;
// A turn of the shaft is not the same number of samples each time.
constexpr double kLengthTolerance = 0.01;
// So many equal samples in a row at the very top or bottom are a sensor at its end.
constexpr int kClippedRun = 6;

int LongestRunAt(std::span<const double> signal, double value) {
  int longest = 0;
  int run = 0;
  for (const double sample : signal) {
    run = sample == value ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  return longest;
}

// What is wrong with the sensor behind a signal.
std::optional<SignalFault> SensorFault(const std::string& channel, std::span<const double> signal) {
  const auto odd = std::ranges::find_if_not(signal, [](double value) { return std::isfinite(value); });
  if (odd != signal.end()) {
    return SignalFault{SignalFaultKind::kNotFinite, fmt::format("{} is {} at sample {} (expected a number)",
                                                                channel, *odd, odd - signal.begin() + 1)};
  }
  const auto [low, high] = std::ranges::minmax(signal);
  if (low == high) {
    return SignalFault{
        SignalFaultKind::kDead,
        fmt::format("{} is {} throughout (expected a signal: is the sensor connected?)", channel, low)};
  }
  for (const double end : {low, high}) {
    const int run = LongestRunAt(signal, end);
    if (run >= kClippedRun) {
      return SignalFault{
          SignalFaultKind::kClipped,
          fmt::format("{} stays at its end value {} for {} samples (expected a sensor within its range)",
                      channel, end, run)};
    }
  }
  return std::nullopt;
}

}  // namespace

std::string_view NameOf(SignalFaultKind kind) {
  switch (kind) {
    case SignalFaultKind::kSampleRate:
      return "sample_rate";
    case SignalFaultKind::kMissingChannel:
      return "missing_channel";
    case SignalFaultKind::kTooShort:
      return "too_short";
    case SignalFaultKind::kNotFinite:
      return "not_finite";
    case SignalFaultKind::kDead:
      return "dead";
    case SignalFaultKind::kClipped:
      return "clipped";
    case SignalFaultKind::kSwapped:
      return "swapped";
    case SignalFaultKind::kUndefined:
      return "undefined";
    case SignalFaultKind::kGap:
      return "gap";
    case SignalFaultKind::kUnreadable:
      return "unreadable";
  }
  return "unreadable";
}

SignalInputs::SignalInputs(const FeatureRecipe& recipe) : recipe_(recipe), by_wavelet_(recipe.wavelet) {
  const std::vector<std::string> names = by_wavelet_.Names(recipe_.channels);
  values_.resize(names.size());
  for (const std::string& input : recipe_.inputs) {
    const auto found = std::ranges::find(names, input);
    if (found == names.end()) {
      throw CampaignError(
          ExitCode::kWrongInput,
          fmt::format("error: the predictor's input '{}' is no feature of its recipe (expected one of "
                      "the channels {})",
                      input, fmt::join(recipe_.channels, ", ")));
    }
    place_.push_back(static_cast<std::size_t>(found - names.begin()));
  }
}

std::optional<SignalFault> SignalInputs::Compute(std::span<const NamedSignal> signals, double sample_rate_hz,
                                                 Eigen::RowVectorXd& inputs) {
  if (!(std::abs(sample_rate_hz / recipe_.sample_rate_hz - 1.0) <= kRateTolerance)) {
    return SignalFault{SignalFaultKind::kSampleRate,
                       fmt::format("the sampling rate is {:g} Hz (expected {:g} Hz, as in training)",
                                   sample_rate_hz, recipe_.sample_rate_hz)};
  }
  const double least = (1.0 - kLengthTolerance) * static_cast<double>(recipe_.least_samples);
  for (const NamedSignal& signal : signals) {
    if (signal.samples.empty() || static_cast<double>(signal.samples.size()) < least) {
      return SignalFault{SignalFaultKind::kTooShort,
                         fmt::format("{} samples (expected at least {}, as in training)",
                                     signal.samples.size(), recipe_.least_samples)};
    }
  }
  const std::size_t per_channel = by_wavelet_.CountPerChannel();
  for (std::size_t k = 0; k < recipe_.channels.size(); ++k) {
    const std::string& channel = recipe_.channels[k];
    const auto signal = std::ranges::find(signals, std::string_view(channel), &NamedSignal::name);
    if (signal == signals.end()) {
      return SignalFault{
          SignalFaultKind::kMissingChannel,
          fmt::format("there is no channel {} (expected {})", channel, fmt::join(recipe_.channels, ", "))};
    }
    if (auto fault = SensorFault(channel, signal->samples)) return fault;
    by_wavelet_.Compute(signal->samples, std::span(values_).subspan(k * per_channel, per_channel));
  }
  inputs.resize(static_cast<Eigen::Index>(place_.size()));
  for (std::size_t i = 0; i < place_.size(); ++i) {
    const double value = values_[place_[i]];
    if (!std::isfinite(value)) {
      return SignalFault{
          SignalFaultKind::kUndefined,
          fmt::format("{} is not defined for this record (expected a number)", recipe_.inputs[i])};
    }
    inputs(static_cast<Eigen::Index>(i)) = value;
  }
  return std::nullopt;
}

Eigen::RowVectorXd SignalInputs::WithExchanged(std::size_t channel, std::size_t other) const {
  const std::size_t per_channel = by_wavelet_.CountPerChannel();
  Eigen::RowVectorXd inputs(static_cast<Eigen::Index>(place_.size()));
  for (std::size_t i = 0; i < place_.size(); ++i) {
    const std::size_t own = place_[i] / per_channel;
    const std::size_t from = own == channel ? other : own == other ? channel : own;
    inputs(static_cast<Eigen::Index>(i)) = values_[from * per_channel + place_[i] % per_channel];
  }
  return inputs;
}

}  // namespace strainwave::bench
