// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/signal_inputs.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/features/decimation.h"
#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

// A turn of the shaft is not the same number of samples each time.
constexpr double kLengthTolerance = 0.01;
}  // namespace

SignalInputs::SignalInputs(const FeatureRecipe& recipe)
    : recipe_(recipe), settings_(recipe.signals()), features_(recipe.features) {
  const std::vector<std::string> names = features_.Names(recipe_.channels);
  values_.resize(names.size());
  for (const std::string& input : recipe_.inputs) {
    const auto found = std::ranges::find(names, input);
    if (found == names.end()) {
      throw BenchError(
          ExitCode::kWrongInput,
          fmt::format("error: the predictor's input '{}' is no feature of its recipe (expected one of "
                      "the channels {})",
                      input, fmt::join(recipe_.channels, ", ")));
    }
    place_.push_back(static_cast<std::size_t>(found - names.begin()));
  }
}

std::optional<SignalFault> SignalInputs::TooShort(std::size_t samples) const {
  const double least = (1.0 - kLengthTolerance) * static_cast<double>(recipe_.least_samples);
  if (samples > 0 && static_cast<double>(samples) >= least) return std::nullopt;
  return SignalFault{
      SignalFaultKind::kTooShort,
      fmt::format("{} samples (expected at least {}, as in training)", samples, recipe_.least_samples)};
}

std::optional<SignalFault> SignalInputs::Compute(std::span<const NamedSignal> signals, double sample_rate_hz,
                                                 std::optional<double> samples_per_turn,
                                                 Eigen::RowVectorXd& inputs) {
  const int factor = DecimationFactor(sample_rate_hz, settings_);
  if (factor == 0) return RateFault(sample_rate_hz, settings_);
  if (samples_per_turn) *samples_per_turn /= factor;
  decimated_.resize(recipe_.channels.size());
  std::vector<std::span<const double>> channels;
  for (std::size_t k = 0; k < recipe_.channels.size(); ++k) {
    const std::string& channel = recipe_.channels[k];
    const auto signal = std::ranges::find(signals, std::string_view(channel), &NamedSignal::name);
    if (signal == signals.end()) return MissingChannel(channel, settings_);
    if (auto fault = TooShort(signal->samples.size() / static_cast<std::size_t>(factor))) return fault;
    if (auto fault = SensorFault(channel, signal->samples)) return fault;
    channels.push_back(signal->samples);
    if (factor == 1) continue;
    decimated_[k] = analysis::features::Decimate(signal->samples, factor);
    channels[k] = decimated_[k];
  }
  return OfChannels(channels, samples_per_turn, inputs);
}

std::optional<SignalFault> SignalInputs::OfChannels(std::span<const std::span<const double>> channels,
                                                    std::optional<double> samples_per_turn,
                                                    Eigen::RowVectorXd& inputs) {
  const std::size_t per_channel = features_.CountPerChannel();
  for (std::size_t k = 0; k < channels.size(); ++k) {
    if (auto fault = TooShort(channels[k].size())) return fault;
    try {
      features_.Compute(channels[k], samples_per_turn,
                        std::span(values_).subspan(k * per_channel, per_channel));
    } catch (const std::invalid_argument& error) {
      return SignalFault{SignalFaultKind::kUndefined, error.what()};
    }
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
  const std::size_t per_channel = features_.CountPerChannel();
  Eigen::RowVectorXd inputs(static_cast<Eigen::Index>(place_.size()));
  for (std::size_t i = 0; i < place_.size(); ++i) {
    const std::size_t own = place_[i] / per_channel;
    const std::size_t from = own == channel ? other : own == other ? channel : own;
    inputs(static_cast<Eigen::Index>(i)) = values_[from * per_channel + place_[i] % per_channel];
  }
  return inputs;
}

}  // namespace strainwave::bench
