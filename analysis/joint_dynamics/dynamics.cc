// SPDX-License-Identifier: Apache-2.0
#include "analysis/joint_dynamics/dynamics.h"

#include <cmath>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>

namespace strainwave::analysis::joint_dynamics {
namespace {

namespace networks = analysis::networks;

constexpr double kValidationShare = 0.2;

}  // namespace

std::vector<Eigen::Index> EvenRows(Eigen::Index rows, Eigen::Index most) {
  std::vector<Eigen::Index> chosen;
  if (rows <= most) {
    chosen.resize(static_cast<std::size_t>(rows));
    std::iota(chosen.begin(), chosen.end(), Eigen::Index{0});
    return chosen;
  }
  for (Eigen::Index i = 0; i < most; ++i) chosen.push_back(most == 1 ? 0 : i * (rows - 1) / (most - 1));
  return chosen;
}

JointMotion RowsOf(const JointMotion& motion, const std::vector<Eigen::Index>& rows) {
  return {motion.states(rows, Eigen::all), motion.torques_Nm(rows, Eigen::all)};
}

JointMotion Stacked(const std::vector<JointMotion>& motions) {
  if (motions.empty()) throw std::invalid_argument("no motion to stack");
  Eigen::Index rows = 0;
  for (const JointMotion& motion : motions) {
    if (motion.joints() != motions.front().joints())
      throw std::invalid_argument("motions differ in the number of their joints");
    rows += motion.size();
  }
  JointMotion all{Eigen::MatrixXd(rows, motions.front().states.cols()),
                  Eigen::MatrixXd(rows, motions.front().joints())};
  Eigen::Index at = 0;
  for (const JointMotion& motion : motions) {
    all.states.middleRows(at, motion.size()) = motion.states;
    all.torques_Nm.middleRows(at, motion.size()) = motion.torques_Nm;
    at += motion.size();
  }
  return all;
}

prediction::Ensemble TrainDynamics(const JointMotion& motion, const std::vector<int>& part,
                                   const DynamicsSettings& settings,
                                   const prediction::TrainingProgress& progress) {
  if (motion.size() < kFewestRows || part.size() != static_cast<std::size_t>(motion.size()))
    throw std::invalid_argument(
        fmt::format("{} rows and {} parts for a network of joint dynamics (expected as many, {} or more)",
                    motion.size(), part.size(), kFewestRows));
  prediction::Samples samples;
  samples.features = motion.states;
  samples.targets = motion.torques_Nm;
  samples.specimen = part;
  for (Eigen::Index row = 0; row < motion.size(); ++row) samples.cycle.push_back(static_cast<double>(row));
  for (Eigen::Index i = 0; i < motion.states.cols(); ++i) samples.inputs.push_back(fmt::format("x{}", i + 1));
  for (Eigen::Index i = 0; i < motion.joints(); ++i)
    samples.outputs.push_back(fmt::format("tau{}_Nm", i + 1));
  prediction::EnsembleSettings ensemble;
  ensemble.design.input = {1, static_cast<int>(motion.states.cols())};
  using networks::Activation, networks::Dense;
  ensemble.design.layers = {Dense{settings.hidden, Activation::kTanh},
                            Dense{settings.hidden, Activation::kTanh},
                            Dense{static_cast<int>(motion.joints()), Activation::kLinear}};
  ensemble.training.loss = networks::Loss::kMse;
  ensemble.training.optimizer = networks::Adam{.rate = settings.rate};
  ensemble.training.epochs = settings.epochs;
  ensemble.training.batch = settings.batch;
  ensemble.training.early_stopping = networks::EarlyStopping{settings.patience};
  ensemble.training.seed = settings.seed;
  ensemble.validation_share = kValidationShare;
  return prediction::TrainEnsemble(samples, ensemble, progress);
}

TorqueErrors ErrorsOf(const prediction::Ensemble& dynamics, const JointMotion& motion) {
  const Eigen::MatrixXd errors = motion.torques_Nm - dynamics.Predict(motion.states).mean;
  const Eigen::RowVectorXd squares = errors.array().square().colwise().mean();
  const Eigen::MatrixXd centred = motion.torques_Nm.rowwise() - motion.torques_Nm.colwise().mean();
  const Eigen::RowVectorXd variance = centred.array().square().colwise().mean();
  TorqueErrors result{squares.cwiseSqrt(), Eigen::RowVectorXd::Zero(squares.size()), squares.mean()};
  for (Eigen::Index j = 0; j < squares.size(); ++j) {
    if (variance(j) > 0.0) result.explained_share(j) = 1.0 - squares(j) / variance(j);
  }
  return result;
}

}  // namespace strainwave::analysis::joint_dynamics
