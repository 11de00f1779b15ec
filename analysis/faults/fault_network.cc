// SPDX-License-Identifier: Apache-2.0
#include "analysis/faults/fault_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "analysis/networks/training.h"

namespace strainwave::analysis::faults {
namespace {

using Columns = networks::Samples<float>;
using Parameters = networks::Vector<float>;

constexpr double kInside = 0.99;  // of records like those trained on that are called known
constexpr int kOurEpochs = 300;
constexpr int kStudyEpochs = 50000;

int EpochsOf(const FaultNetworkSettings& settings) {
  if (settings.epochs > 0) return settings.epochs;
  return settings.line == FaultLine::kOurs ? kOurEpochs : kStudyEpochs;
}

bool IsSoftmax(const FaultNetworkSettings& settings) {
  return settings.line == FaultLine::kOurs && !settings.labels;
}

// From 0 to 1 over the training; a column that does not vary keeps a scale of one.
prediction::Scaler FromZeroToOne(const Eigen::MatrixXd& values) {
  prediction::Scaler scaler{.offset = values.colwise().minCoeff(), .scale = values.colwise().maxCoeff()};
  scaler.scale -= scaler.offset;
  for (double& scale : scaler.scale) {
    if (!(scale > 0.0)) scale = 1.0;
  }
  return scaler;
}

networks::Design DesignFor(const prediction::Samples& samples, const FaultNetworkSettings& settings) {
  const auto inputs = static_cast<int>(samples.features.cols());
  const auto outputs = static_cast<int>(samples.targets.cols());
  const bool ours = settings.line == FaultLine::kOurs;
  using networks::Activation;
  return {.input = {1, inputs},
          .layers = {networks::Dense{settings.hidden, ours ? Activation::kTanh : Activation::kSigmoid},
                     networks::Dense{outputs,
                                     ours && settings.labels ? Activation::kSigmoid : Activation::kLinear}}};
}

// Of one member; `after` is asked after each epoch and ends the training with false.
void TrainOurs(const networks::Network& network, const Columns& training,
               const FaultNetworkSettings& settings, std::uint64_t seed,
               const std::function<bool(int)>& after, Parameters& parameters) {
  constexpr double kRate = 5e-3;
  constexpr double kDecay = 1e-3;
  networks::TrainingOptions options{
      .loss = IsSoftmax(settings) ? networks::Loss::kCrossEntropy : networks::Loss::kMse,
      .optimizer = networks::Adam{.rate = kRate},
      .schedule = networks::CosineRate{},
      .epochs = EpochsOf(settings),
      .batch = 32,
      // Squared errors of shares are some five times smaller than cross-entropies.
      .weight_decay = IsSoftmax(settings) ? kDecay : 0.2 * kDecay,
      .seed = seed};
  options.progress = [&after](int epoch, double) { return after(epoch); };
  networks::Train<float>(network, training, {}, options, parameters);
}

// @return why it ended.
std::string_view TrainAsStudy(const networks::Network& network, const Columns& training,
                              const FaultNetworkSettings& settings, const std::function<bool(int)>& after,
                              Parameters& parameters) {
  networks::BatchGradient<float> batch(network, networks::Loss::kMse, InTurn);
  networks::Optimizer<float> optimizer(networks::MomentumDescent{.rate = 0.05, .momentum = 0.9},
                                       network.parameter_count());
  const int epochs = EpochsOf(settings);
  for (int epoch = 0; epoch < epochs; ++epoch) {
    const double error = batch.Compute(parameters, training.inputs, training.targets);
    if (!std::isfinite(error))
      throw std::domain_error(fmt::format("the error is {} in epoch {} (expected a number)", error, epoch));
    if (error <= settings.least_error) return "error";
    if (static_cast<double>(batch.gradient().norm()) <= settings.least_gradient) return "gradient";
    optimizer.Step(batch.gradient(), 1.0, parameters);
    if (!after(epoch)) break;
  }
  return "epochs";
}

Columns ColumnsOf(const prediction::Samples& samples, const prediction::Scaler& scaler) {
  return {.inputs = scaler.Apply(samples.features).transpose().cast<float>(),
          .targets = samples.targets.transpose().cast<float>()};
}

prediction::Ensemble EmptyEnsemble(const prediction::Samples& samples, const FaultNetworkSettings& settings) {
  prediction::Check(samples);
  if (settings.hidden < 1 || settings.members < 1)
    throw std::invalid_argument(fmt::format("hidden = {}, members = {} (expected one or more of each)",
                                            settings.hidden, settings.members));
  return {.input = settings.line == FaultLine::kOurs ? prediction::Standardizing(samples.features)
                                                     : FromZeroToOne(samples.features),
          .output = prediction::Unscaled(samples.targets.cols()),
          .network = networks::Network(DesignFor(samples, settings)),
          .members = {},
          .softmax = IsSoftmax(settings)};
}

double SquaredError(const prediction::Ensemble& ensemble, const prediction::Samples& samples) {
  if (samples.size() == 0) return std::numeric_limits<double>::quiet_NaN();
  return (ensemble.Predict(samples.features).mean - samples.targets).array().square().mean();
}

}  // namespace

std::string_view NameOf(FaultLine line) { return line == FaultLine::kOurs ? "ours" : "study"; }

FaultLine FaultLineOf(std::string_view name) {
  for (const FaultLine line : {FaultLine::kOurs, FaultLine::kStudy}) {
    if (name == NameOf(line)) return line;
  }
  throw std::invalid_argument(fmt::format("line = '{}' is not known (expected ours or study)", name));
}

prediction::Ensemble TrainFaultNetwork(const prediction::Samples& samples,
                                       const FaultNetworkSettings& settings) {
  prediction::Ensemble ensemble = EmptyEnsemble(samples, settings);
  const Columns training = ColumnsOf(samples, ensemble.input);
  const auto go_on = [](int) { return true; };
  const int members = settings.line == FaultLine::kOurs ? settings.members : 1;
  for (int member = 0; member < members; ++member) {
    const std::uint64_t seed = settings.seed + static_cast<std::uint64_t>(member);
    auto parameters = networks::InitialParameters<float>(ensemble.network, seed);
    if (settings.line == FaultLine::kOurs) {
      TrainOurs(ensemble.network, training, settings, seed, go_on, parameters);
    } else {
      TrainAsStudy(ensemble.network, training, settings, go_on, parameters);
    }
    ensemble.members.emplace_back(parameters.cast<double>());
  }
  return ensemble;
}

FaultCrossFit CrossFitFaults(const prediction::Samples& samples, const FaultFolds& folds,
                             const FaultNetworkSettings& settings, const ParallelFor& parallel,
                             const std::function<bool()>& done) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  FaultCrossFit all{Eigen::MatrixXd::Constant(samples.size(), samples.targets.cols(), kNone),
                    Eigen::VectorXd::Constant(samples.size(), kNone)};
  std::atomic<bool> go_on{true};
  parallel(folds.folds.size(), [&](std::size_t k) {
    if (!go_on) return;
    const prediction::Split& fold = folds.folds[k];
    const prediction::Samples seen = prediction::Rows(samples, fold.train);
    const prediction::Ensemble ensemble = TrainFaultNetwork(seen, settings);
    const prediction::Samples unseen = prediction::Rows(samples, fold.test);
    const Eigen::MatrixXd probability = ensemble.Predict(unseen.features).mean;
    const Eigen::MatrixXd inputs = ensemble.input.Apply(seen.features);
    const prediction::Novelty novelty = prediction::FitNovelty(inputs, inputs, kInside);
    const Eigen::VectorXd distance = novelty.Distance(ensemble.input.Apply(unseen.features)) / novelty.limit;
    for (std::size_t i = 0; i < fold.test.size(); ++i) {
      all.probability.row(fold.test[i]) = probability.row(static_cast<Eigen::Index>(i));
      all.distance(fold.test[i]) = distance(static_cast<Eigen::Index>(i));
    }
    if (!done()) go_on = false;
  });
  if (!go_on) throw prediction::TrainingEnded();
  return all;
}

double DistanceKeptOutside(const FaultCrossFit& cross) {
  std::vector<Eigen::Index> tested;
  for (Eigen::Index row = 0; row < cross.distance.size(); ++row) {
    if (std::isfinite(cross.distance(row))) tested.push_back(row);
  }
  return tested.empty() ? 1.0 : std::max(1.0, prediction::DistanceKept(cross.distance(tested), kInside));
}

prediction::FittedPredictor FitFaults(const prediction::Samples& samples,
                                      const FaultNetworkSettings& settings, const FaultCrossFit& cross) {
  const Eigen::Index outputs = samples.targets.cols();
  prediction::FittedPredictor fitted{
      .ensemble = TrainFaultNetwork(samples, settings),
      .residual = Eigen::RowVectorXd::Constant(outputs, 1e-300),
      .band = {.coverage = 0.0, .factor = Eigen::RowVectorXd::Zero(outputs), .guaranteed = false},
      .novelty = {},
      .least = samples.features.colwise().minCoeff(),
      .greatest = samples.features.colwise().maxCoeff()};
  std::vector<Eigen::Index> tested;
  for (Eigen::Index row = 0; row < samples.size(); ++row) {
    if (std::isfinite(cross.distance(row))) tested.push_back(row);
  }
  const Eigen::MatrixXd inputs = fitted.ensemble.input.Apply(samples.features);
  fitted.novelty = prediction::FitNovelty(inputs, inputs, kInside);
  if (tested.empty()) return fitted;
  const Eigen::MatrixXd error = cross.probability(tested, Eigen::all) - samples.targets(tested, Eigen::all);
  fitted.residual = error.array().square().colwise().mean().sqrt().max(1e-300);
  if (!fitted.ensemble.softmax) {
    constexpr double kCoverage = 0.9;
    std::vector<int> group;
    for (const Eigen::Index row : tested) group.push_back(samples.specimen[static_cast<std::size_t>(row)]);
    fitted.band = prediction::CalibrateBand(
        samples.targets(tested, Eigen::all), cross.probability(tested, Eigen::all),
        fitted.residual.replicate(static_cast<Eigen::Index>(tested.size()), 1), group, kCoverage);
  }
  // The limit by records that the covariance had not seen, as every later record is; in units of the
  // training's own deviations both measure alike.
  fitted.novelty.limit *= DistanceKeptOutside(cross);
  return fitted;
}

FaultTrainingCourse CourseOfTraining(const prediction::Samples& samples,
                                     const FaultNetworkSettings& settings) {
  constexpr int kTwentieths = 20;
  constexpr int kPart = 3;  // of these: 15 % to validate, 15 % to test
  const FaultFolds dealt = FoldsAtRandom(samples.targets, kTwentieths, settings.seed);
  std::vector<Eigen::Index> parts[3];
  for (std::size_t fold = 0; fold < dealt.folds.size(); ++fold) {
    std::vector<Eigen::Index>& part = parts[fold < kPart ? 1 : fold < 2 * kPart ? 2 : 0];
    part.insert(part.end(), dealt.folds[fold].test.begin(), dealt.folds[fold].test.end());
  }
  FaultTrainingCourse course;
  course.end = "epochs";
  if (parts[0].empty()) return course;
  const prediction::Samples training = prediction::Rows(samples, parts[0]);
  const prediction::Samples validation = prediction::Rows(samples, parts[1]);
  const prediction::Samples test = prediction::Rows(samples, parts[2]);
  prediction::Ensemble ensemble = EmptyEnsemble(training, settings);
  auto parameters = networks::InitialParameters<float>(ensemble.network, settings.seed);
  // A point where the course is looked at is a share further than the one before.
  int next = 0;
  const auto look = [&](int epoch) {
    if (epoch < next) return true;
    next = std::max(epoch + 1, static_cast<int>(1.05 * epoch));
    ensemble.members = {parameters.cast<double>()};
    course.epoch.push_back(epoch + 1);
    course.training.push_back(SquaredError(ensemble, training));
    course.validation.push_back(SquaredError(ensemble, validation));
    course.test.push_back(SquaredError(ensemble, test));
    return true;
  };
  const Columns columns = ColumnsOf(training, ensemble.input);
  if (settings.line == FaultLine::kOurs) {
    TrainOurs(ensemble.network, columns, settings, settings.seed, look, parameters);
  } else {
    course.end = TrainAsStudy(ensemble.network, columns, settings, look, parameters);
  }
  return course;
}

}  // namespace strainwave::analysis::faults
