// SPDX-License-Identifier: Apache-2.0
#include "analysis/joint_dynamics/excess_friction.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <boost/math/distributions/students_t.hpp>

namespace strainwave::analysis::joint_dynamics {

using Eigen::Index;

double ExcessFriction::Score(const Eigen::RowVectorXd& against) const {
  return (against - mean).cwiseQuotient(deviation).maxCoeff();
}

ExcessFriction FitExcessFriction(const Eigen::MatrixXd& healthy) {
  constexpr double kFalseAlarms = 0.05;
  const Index files = healthy.rows();
  if (files < kFewestHealthyFiles)
    throw std::invalid_argument(
        fmt::format("{} healthy files (expected {} or more)", files, kFewestHealthyFiles));
  const auto n = static_cast<double>(files);
  ExcessFriction excess;
  excess.mean = healthy.colwise().mean();
  const Eigen::RowVectorXd variance =
      (healthy.rowwise() - excess.mean).array().square().colwise().sum() / (n - 1.0);
  // A joint that is the same in all of them to the last digit was not measured.
  excess.deviation = (variance * (1.0 + 1.0 / n)).cwiseSqrt().cwiseMax(1e-12);
  const boost::math::students_t distribution(n - 1.0);
  excess.limit = boost::math::quantile(
      boost::math::complement(distribution, kFalseAlarms / static_cast<double>(healthy.cols())));
  return excess;
}

Eigen::MatrixXd MeanAgainstMotion(const Eigen::MatrixXd& fingerprints, std::span<const int> file, Index files,
                                  Index joints) {
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(files, joints);
  Eigen::VectorXd samples = Eigen::VectorXd::Zero(files);
  for (std::size_t i = 0; i < file.size(); ++i) {
    mean.row(file[i]) += fingerprints.row(static_cast<Index>(i)).segment(joints, joints);
    samples(file[i]) += 1.0;
  }
  return mean.array().colwise() / samples.array().max(1.0);
}

}  // namespace strainwave::analysis::joint_dynamics
