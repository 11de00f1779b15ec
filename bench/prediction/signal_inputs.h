// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "bench/prediction/feature_recipe.h"

namespace strainwave::bench {

/// Turns signals into the inputs of a predictor. Keeps its memory from call to call; one object a thread.
class SignalInputs {
 public:
  /// @throws BenchError if an input is no feature of the recipe's channels.
  explicit SignalInputs(const FeatureRecipe& recipe);

  /// @param signals  in any order; those that the recipe does not name are not looked at.
  /// @param samples_per_turn  of the input shaft, at the signals' rate; only energies by order need it.
  /// @param inputs  gets the features of the recipe, in its order; undefined after a fault.
  /// @return what is not as in training: another rate or too few samples (by more than a hundredth), a
  ///   channel that is missing, a value that is no number, a dead or a clipped sensor, a feature that is not
  ///   defined.
  std::optional<SignalFault> Compute(std::span<const NamedSignal> signals, double sample_rate_hz,
                                     std::optional<double> samples_per_turn, Eigen::RowVectorXd& inputs);

  /// The same of channels in the recipe's order, at its rate, from sensors that were found alive.
  std::optional<SignalFault> OfChannels(std::span<const std::span<const double>> channels,
                                        std::optional<double> samples_per_turn, Eigen::RowVectorXd& inputs);

  /// The inputs of the last call, had the signals of two of the recipe's channels been exchanged.
  Eigen::RowVectorXd WithExchanged(std::size_t channel, std::size_t other) const;

 private:
  std::optional<SignalFault> TooShort(std::size_t samples) const;

  FeatureRecipe recipe_;
  SignalSettings settings_;
  ChannelFeatures features_;
  std::vector<std::size_t> place_;              // of each input among all features
  std::vector<double> values_;                  // all features, channel by channel
  std::vector<std::vector<double>> decimated_;  // where the signals come at a multiple of the rate
};

}  // namespace strainwave::bench
