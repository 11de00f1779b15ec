// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "bench/prediction/operating_envelope.h"
#include "bench/prediction/signal_settings.h"
#include "daq/record_kind.h"

namespace strainwave::bench {

/// What one window of signals says, in the outputs' units; of classes, their probabilities, without a
/// width.
struct PredictedOutputs {
  std::vector<double> value;
  std::vector<double> half_width;
  double distance{};                // above 1: outside what was trained on, nothing is promised
  std::vector<std::string> left{};  // of the torques, speeds and temperatures of the training, in words

  bool outside_training() const { return !(distance <= 1.0) || !left.empty(); }
};

/// What a model takes of a stream.
struct SignalNeeds {
  daq::RecordKind records;  // that it was trained on
  SignalSettings signals;
  WindowLength window;
  std::size_t least_samples{};  // of a window
};

/// A model that was exported, as a monitor runs it. One object a thread.
class ExportedModel {
 public:
  virtual ~ExportedModel() = default;

  virtual SignalNeeds needs() const = 0;
  virtual const std::vector<std::string>& outputs() const = 0;
  virtual bool classes() const = 0;
  virtual double coverage() const = 0;            // of the intervals
  virtual double worst_disagreement() const = 0;  // of the self-test
  /// Of torque, speed and temperature what the training had and this does not tell, in words.
  virtual std::vector<std::string> NotKnown(const OperatingPoint& operating) const = 0;

  /// @param signals  in any order, samples at `sample_rate_hz`.
  /// @param samples_per_turn  of the input shaft, where it is known; energies by order need it.
  /// @param operating  under what the reducer runs, as far as it is known.
  /// @return the outputs, or why there are none.
  virtual std::variant<PredictedOutputs, SignalFault> Predict(std::span<const NamedSignal> signals,
                                                              double sample_rate_hz,
                                                              std::optional<double> samples_per_turn,
                                                              const OperatingPoint& operating) = 0;

 protected:
  ExportedModel() = default;
  ExportedModel(const ExportedModel&) = default;
  ExportedModel(ExportedModel&&) = default;
  ExportedModel& operator=(const ExportedModel&) = default;
  ExportedModel& operator=(ExportedModel&&) = default;
};

}  // namespace strainwave::bench
