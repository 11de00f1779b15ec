// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "analysis/networks/batch_gradient.h"
#include "analysis/networks/optimizer.h"
#include "analysis/networks/rate_schedule.h"

namespace strainwave::analysis::networks {

/// Samples as columns, in the same order.
template <typename Scalar>
struct Samples {
  Matrix<Scalar> inputs;
  Matrix<Scalar> targets;
};

/// Ends the training when the loss of the validation samples has not fallen for `patience` epochs, and goes
/// back to the parameters of the best one.
struct EarlyStopping {
  int patience{50};
};

/// By default as in docs/sources.md#shivam-2023.
struct TrainingOptions {
  Loss loss{Loss::kMape};
  OptimizerSettings optimizer{Adam{}};
  RateSchedule schedule{ConstantRate{}};
  int epochs{1000};
  int batch{32};          // samples; the last one of an epoch may have fewer
  double weight_decay{};  // adds half of it times the square of each weight, not of biases, to the loss
  std::optional<EarlyStopping> early_stopping{};
  std::uint64_t seed{1};  // of the order of the samples
  ParallelFor parallel{InTurn};
  std::function<bool(int epoch, double loss)> progress{};  // after each epoch; false ends the training
};

enum class TrainingEnd { kAllEpochs, kNoLongerBetter, kByCaller };

struct TrainingHistory {
  std::vector<double> loss;  // of each epoch: mean over its batches as they were met, without decay
  std::vector<double> validation_loss;  // after each epoch; empty without validation samples
  int best_epoch{};                     // whose parameters are left
  TrainingEnd end{TrainingEnd::kAllEpochs};
};

/// Changes `parameters` by gradient steps over batches drawn anew every epoch. Samples, parameters and
/// options alone decide the result, to the bit, whatever `parallel` does.
///
/// @param validation  samples apart from the others; without columns: none.
/// @throws std::invalid_argument if sizes do not fit, a value is not finite, a target is 0 under MAPE, an
/// option is out
///   of range, or early stopping has no validation samples;
/// @throws std::domain_error if the loss is no longer finite; the parameters are then those of the epoch
///   before.
template <typename Scalar>
TrainingHistory Train(const Network& network, const Samples<Scalar>& training,
                      const Samples<Scalar>& validation, const TrainingOptions& options,
                      Vector<Scalar>& parameters);

}  // namespace strainwave::analysis::networks
