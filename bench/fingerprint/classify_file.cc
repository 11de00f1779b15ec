// SPDX-License-Identifier: Apache-2.0
#include "bench/fingerprint/classify_file.h"

#include <fmt/format.h>

#include "analysis/explanation/kernel_shap.h"
#include "analysis/explanation/network_game.h"
#include "analysis/explanation/shapley.h"
#include "analysis/joint_dynamics/nominal.h"
#include "bench/campaign/on_all_processors.h"
#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

namespace dynamics = analysis::joint_dynamics;
namespace explanation = analysis::explanation;
using Eigen::Index;

// Columns are rows of the background.
void SoftmaxOf(explanation::NetworkGame::Rows& outputs) {
  outputs.rowwise() -= outputs.colwise().maxCoeff().eval();
  outputs = outputs.array().exp();
  outputs.array().rowwise() /= outputs.colwise().sum().array().eval();
}

// Of the probability of a fault, mean over the samples.
std::vector<double> AttributeToJoints(const FingerprintModel& model, const Eigen::MatrixXd& fingerprints) {
  const Index joints = model.joints();
  explanation::NetworkGame game(model.classifier.network, model.classifier.members.front(),
                                dynamics::ColumnsOfJoints(model.attribution.fingerprint, joints),
                                model.classifier.input.Apply(model.healthy_fingerprints).transpose(),
                                SoftmaxOf);
  const Eigen::MatrixXd scaled = model.classifier.input.Apply(fingerprints).transpose();
  std::vector<double> mean(static_cast<std::size_t>(joints), 0.0);
  for (Index row = 0; row < scaled.cols(); ++row) {
    game.SetSample(scaled.col(row));
    // Outputs are the probabilities of healthy and faulty, side by side for each joint.
    const std::vector<double> shares =
        joints <= dynamics::kMostExactByDefault
            ? explanation::ShapleyValues(
                  game.players(), 2,
                  [&](explanation::Coalition coalition, double* out) { game.Value(coalition, out); })
            : explanation::KernelShap(game.players(), 2, [&](explanation::PlayerSet coalition, double* out) {
                game.Value(coalition, out);
              }).shares;
    for (std::size_t j = 0; j < mean.size(); ++j)
      mean[j] += shares[2 * j + 1] / static_cast<double>(scaled.cols());
  }
  return mean;
}

}  // namespace

FileVerdict ClassifyFile(const FingerprintModel& model, const std::filesystem::path& path) {
  JointFile file = ReadJointFile(
      path, model.smoothing, model.acceleration_measured ? Acceleration::kAsThere : Acceleration::kDerived);
  if (file.motion.joints() != model.joints())
    Refuse(path, fmt::format("has {} joints", file.motion.joints()),
           fmt::format("{}, as the model", model.joints()));
  FileVerdict verdict;
  verdict.file = path;
  verdict.warnings = std::move(file.warnings);
  if (model.acceleration_measured && !file.acceleration_measured)
    verdict.warnings.emplace_back(
        "has no accelerations, which the model was trained with; they were computed from the "
        "velocities");
  const dynamics::JointMotion samples =
      dynamics::RowsOf(file.motion, dynamics::EvenRows(file.motion.size(), model.samples));
  verdict.samples = samples.size();
  const Eigen::MatrixXd attributions =
      dynamics::Attribute(model.nominal, samples.states, model.background, model.attribution, OnAllProcessors)
          .fingerprints;
  const Eigen::MatrixXd fingerprints = dynamics::NominalFingerprints(model.nominal, samples, attributions);
  verdict.probability = model.classifier.Predict(fingerprints).mean.col(1).mean();
  verdict.usual = model.classifier.Predict(model.healthy_fingerprints).mean.col(1).mean();
  verdict.attribution = AttributeToJoints(model, fingerprints);
  const dynamics::TorqueErrors errors = dynamics::ErrorsOf(model.nominal, samples);
  verdict.residual_Nm.assign(errors.rmse_Nm.begin(), errors.rmse_Nm.end());
  Index outside = 0;
  for (Index row = 0; row < samples.size(); ++row) {
    const auto state = samples.states.row(row).array();
    if ((state < model.lowest.array()).any() || (state > model.highest.array()).any()) ++outside;
  }
  verdict.outside_share = static_cast<double>(outside) / static_cast<double>(samples.size());
  constexpr double kOften = 0.05;
  if (verdict.outside_share > kOften)
    verdict.warnings.push_back(
        fmt::format("{:.0f} % of the samples have positions, velocities or accelerations that "
                    "the training never had: the probability is no more than a guess there",
                    100.0 * verdict.outside_share));
  return verdict;
}

}  // namespace strainwave::bench
