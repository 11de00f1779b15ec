// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/ensemble.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "analysis/prediction/ridge.h"
#include "analysis/prediction/splits.h"

namespace strainwave::analysis::prediction {
namespace {

using Columns = networks::Samples<float>;

Columns ColumnsOf(const Samples& samples, const std::vector<Eigen::Index>& rows, const Ensemble& ensemble) {
  const Eigen::MatrixXd inputs = ensemble.input.Apply(samples.features(rows, Eigen::all));
  Eigen::MatrixXd targets = samples.targets(rows, Eigen::all);
  if (!ensemble.line.empty()) targets -= ensemble.line.Along(inputs);
  return {.inputs = inputs.transpose().cast<float>(),
          .targets = ensemble.output.Apply(targets).transpose().cast<float>()};
}

constexpr double kReach = 0.25;  // of a line beyond what it was trained on, a share of that range

void AddLine(const Samples& samples, Ensemble& ensemble) {
  const Eigen::MatrixXd inputs = ensemble.input.Apply(samples.features);
  const Eigen::RowVectorXd least = inputs.colwise().minCoeff();
  const Eigen::RowVectorXd greatest = inputs.colwise().maxCoeff();
  ensemble.line = {.slope = FitRidge(inputs, samples.targets, samples.specimen).slope,
                   .lowest = least - kReach * (greatest - least),
                   .highest = greatest + kReach * (greatest - least)};
  ensemble.output = Standardizing(samples.targets - inputs * ensemble.line.slope);
}

Scaler OutputScaler(const Eigen::MatrixXd& targets, networks::Loss loss) {
  switch (loss) {
    case networks::Loss::kMape:
      return Dividing(targets);
    case networks::Loss::kCrossEntropy:
      return Unscaled(targets.cols());
    case networks::Loss::kMse:
    case networks::Loss::kMae:
      break;
  }
  return Standardizing(targets);
}

Eigen::MatrixXd Softmax(const Eigen::MatrixXd& rows) {
  const Eigen::MatrixXd shares = (rows.colwise() - rows.rowwise().maxCoeff()).array().exp();
  return shares.array().colwise() / shares.rowwise().sum().array();
}

// The rows to learn from, and those that tell when to stop.
Split RowsFor(const Samples& samples, double validation_share) {
  if (validation_share <= 0.0) {
    Split all;
    for (Eigen::Index row = 0; row < samples.size(); ++row) all.train.push_back(row);
    return all;
  }
  const int folds = std::max(2, static_cast<int>(std::lround(1.0 / validation_share)));
  return SplitsByBlocks(samples.specimen, samples.cycle, folds).front();
}

}  // namespace

Eigen::MatrixXd Line::Along(const Eigen::MatrixXd& scaled) const {
  const Eigen::Index n = scaled.rows();
  return scaled.cwiseMax(lowest.replicate(n, 1)).cwiseMin(highest.replicate(n, 1)) * slope;
}

Ensemble::Prediction Ensemble::Predict(const Eigen::MatrixXd& features) const {
  const Eigen::MatrixXd inputs = input.Apply(features);
  const networks::Matrix<double> scaled = inputs.transpose();
  const auto count = static_cast<double>(members.size());
  Prediction prediction{Eigen::MatrixXd::Zero(features.rows(), network.output_size()),
                        Eigen::MatrixXd::Zero(features.rows(), network.output_size())};
  networks::Pass<double> pass;
  std::vector<Eigen::MatrixXd> each;
  for (const networks::Vector<double>& parameters : members) {
    const Eigen::MatrixXd raw = networks::Forward<double>(network, parameters, scaled, pass).transpose();
    each.push_back(softmax ? Softmax(raw) : output.Undo(raw));
    prediction.mean += each.back() / count;
  }
  if (members.size() > 1) {
    for (const Eigen::MatrixXd& one : each) {
      prediction.spread.array() += (one - prediction.mean).array().square() / (count - 1.0);
    }
    prediction.spread = prediction.spread.cwiseSqrt();
  }
  if (!line.empty()) prediction.mean += line.Along(inputs);
  return prediction;
}

Ensemble TrainEnsemble(const Samples& samples, const EnsembleSettings& settings,
                       const TrainingProgress& progress) {
  Check(samples);
  Ensemble ensemble{.input = Standardizing(samples.features),
                    .output = OutputScaler(samples.targets, settings.training.loss),
                    .network = networks::Network(settings.design),
                    .members = {},
                    .softmax = settings.training.loss == networks::Loss::kCrossEntropy};
  if (ensemble.network.input_size() != samples.features.cols() ||
      ensemble.network.output_size() != samples.targets.cols() || settings.members < 1) {
    throw std::invalid_argument(
        fmt::format("a design of {} inputs and {} outputs, {} members, for samples of {} and {} (expected "
                    "the same, one member "
                    "or more)",
                    ensemble.network.input_size(), ensemble.network.output_size(), settings.members,
                    samples.features.cols(), samples.targets.cols()));
  }
  const Split rows = RowsFor(samples, settings.validation_share);
  if (settings.beside_line) AddLine(Rows(samples, rows.train), ensemble);
  const Columns training = ColumnsOf(samples, rows.train, ensemble);
  const Columns validation = ColumnsOf(samples, rows.test, ensemble);
  ensemble.members.resize(static_cast<std::size_t>(settings.members));
  std::atomic<bool> go_on{true};
  settings.parallel(ensemble.members.size(), [&](std::size_t member) {
    networks::TrainingOptions options = settings.training;
    options.seed += member;
    options.progress = [&](int epoch, double loss) {
      if (progress && !progress(static_cast<int>(member), epoch, loss)) go_on = false;
      return go_on.load();
    };
    auto parameters = networks::InitialParameters<float>(ensemble.network, options.seed);
    networks::Train<float>(ensemble.network, training, validation, options, parameters);
    ensemble.members[member] = parameters.cast<double>();
  });
  if (!go_on) throw TrainingEnded();
  return ensemble;
}

}  // namespace strainwave::analysis::prediction
