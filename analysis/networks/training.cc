// SPDX-License-Identifier: Apache-2.0
#include "analysis/networks/training.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string_view>

#include "analysis/arguments.h"
#include "analysis/shuffle.h"

namespace strainwave::analysis::networks {
namespace {

using Eigen::Index;

template <typename Scalar>
void RequireSamples(std::string_view name, const Network& network, const Samples<Scalar>& samples,
                    Loss loss) {
  const auto require = [&](std::string_view part, const Matrix<Scalar>& values, Index rows) {
    if (values.rows() != rows || values.cols() != samples.inputs.cols()) {
      throw std::invalid_argument(fmt::format("{}.{} is {} × {} (expected {} × {})", name, part,
                                              values.rows(), values.cols(), rows, samples.inputs.cols()));
    }
    if (!values.allFinite())
      throw std::invalid_argument(fmt::format("{}.{} has a value that is not finite", name, part));
  };
  require("inputs", samples.inputs, network.input_size());
  require("targets", samples.targets, network.output_size());
  if (loss == Loss::kMape && (samples.targets.array() == Scalar(0)).any()) {
    throw std::invalid_argument(
        fmt::format("{}.targets has a zero, of which no error is a share in percent", name));
  }
}

template <typename Scalar>
void RequireOptions(const TrainingOptions& options, const Samples<Scalar>& validation) {
  if (options.epochs < 1)
    throw std::invalid_argument(fmt::format("epochs = {} is not from 1 up", options.epochs));
  if (options.batch < 1)
    throw std::invalid_argument(fmt::format("batch = {} is not from 1 up", options.batch));
  RequireNotNegative("weight_decay", options.weight_decay);
  if (!options.early_stopping) return;
  if (options.early_stopping->patience < 1) {
    throw std::invalid_argument(
        fmt::format("patience = {} is not from 1 up", options.early_stopping->patience));
  }
  if (validation.inputs.cols() == 0) {
    throw std::invalid_argument("validation has no samples (expected some for early stopping)");
  }
}

// The samples of one batch, next to one another.
template <typename Scalar>
void Collect(const Matrix<Scalar>& all, const std::vector<Index>& order, Index begin, Index count,
             Matrix<Scalar>& batch) {
  batch.resize(all.rows(), count);
  for (Index i = 0; i < count; ++i) batch.col(i) = all.col(order[static_cast<std::size_t>(begin + i)]);
}

template <typename Scalar>
class Epochs {
 public:
  Epochs(const Network& network, const Samples<Scalar>& training, const TrainingOptions& options)
      : network_(network),
        training_(training),
        options_(options),
        batches_(network, options.loss, options.parallel),
        optimizer_(options.optimizer, network.parameter_count()),
        random_(options.seed),
        order_(static_cast<std::size_t>(training.inputs.cols())) {
    std::iota(order_.begin(), order_.end(), Index{0});
  }

  // The mean loss of the batches.
  double Run(int epoch, Vector<Scalar>& parameters) {
    const Index samples = training_.inputs.cols();
    const double factor = RateFactor(options_.schedule, epoch, options_.epochs);
    if (samples > options_.batch) Shuffle(order_, random_);
    double loss = 0.0;
    for (Index begin = 0; begin < samples; begin += options_.batch) {
      const Index count = std::min<Index>(options_.batch, samples - begin);
      Collect(training_.inputs, order_, begin, count, inputs_);
      Collect(training_.targets, order_, begin, count, targets_);
      loss += batches_.Compute(parameters, inputs_, targets_) * static_cast<double>(count);
      AddDecay(parameters);
      optimizer_.Step(batches_.gradient(), factor, parameters);
    }
    return loss / static_cast<double>(samples);
  }

  double LossOf(const Samples<Scalar>& samples, const Vector<Scalar>& parameters) {
    return batches_.ComputeLoss(parameters, samples.inputs, samples.targets);
  }

 private:
  void AddDecay(const Vector<Scalar>& parameters) {
    if (options_.weight_decay == 0.0) return;
    for (const Network::Stage& stage : network_.stages()) {
      batches_.gradient().segment(stage.weights_begin, stage.weights) +=
          static_cast<Scalar>(options_.weight_decay) * parameters.segment(stage.weights_begin, stage.weights);
    }
  }

  const Network& network_;
  const Samples<Scalar>& training_;
  const TrainingOptions& options_;
  BatchGradient<Scalar> batches_;
  Optimizer<Scalar> optimizer_;
  std::mt19937_64 random_;
  std::vector<Index> order_;
  Matrix<Scalar> inputs_;
  Matrix<Scalar> targets_;
};

}  // namespace

template <typename Scalar>
TrainingHistory Train(const Network& network, const Samples<Scalar>& training,
                      const Samples<Scalar>& validation, const TrainingOptions& options,
                      Vector<Scalar>& parameters) {
  RequireSamples("training", network, training, options.loss);
  if (training.inputs.cols() == 0)
    throw std::invalid_argument("training has no samples (expected at least one)");
  const bool validates = validation.inputs.cols() > 0;
  if (validates) RequireSamples("validation", network, validation, options.loss);
  RequireOptions(options, validation);
  Epochs<Scalar> epochs(network, training, options);
  TrainingHistory history;
  Vector<Scalar> before = parameters;
  Vector<Scalar> best = parameters;
  double best_loss = std::numeric_limits<double>::infinity();
  for (int epoch = 0; epoch < options.epochs; ++epoch) {
    before = parameters;
    const double loss = epochs.Run(epoch, parameters);
    if (!std::isfinite(loss) || !parameters.allFinite()) {
      parameters = before;
      throw std::domain_error(
          fmt::format("the loss is {} in epoch {} (expected a lower learning rate)", loss, epoch));
    }
    history.loss.push_back(loss);
    if (validates) history.validation_loss.push_back(epochs.LossOf(validation, parameters));
    if (!options.early_stopping) {
      history.best_epoch = epoch;
    } else if (history.validation_loss.back() < best_loss) {
      best_loss = history.validation_loss.back();
      best = parameters;
      history.best_epoch = epoch;
    } else if (epoch - history.best_epoch >= options.early_stopping->patience) {
      history.end = TrainingEnd::kNoLongerBetter;
    }
    if (options.progress && !options.progress(epoch, loss)) history.end = TrainingEnd::kByCaller;
    if (history.end != TrainingEnd::kAllEpochs) break;
  }
  if (options.early_stopping) parameters = best;
  return history;
}

template TrainingHistory Train(const Network&, const Samples<float>&, const Samples<float>&,
                               const TrainingOptions&, Vector<float>&);
template TrainingHistory Train(const Network&, const Samples<double>&, const Samples<double>&,
                               const TrainingOptions&, Vector<double>&);

}  // namespace strainwave::analysis::networks
