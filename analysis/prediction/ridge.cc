// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/ridge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <vector>

#include "analysis/decompositions.h"

namespace strainwave::analysis::prediction {
namespace {

constexpr int kFolds = 5;
constexpr double kPenalties[] = {1e-5, 1e-4, 1e-3, 1e-2, 3e-2, 1e-1, 3e-1, 1.0, 3.0, 10.0};

// XᵀX = V D Vᵀ once; each penalty is then a division.
class PenalizedFit {
 public:
  PenalizedFit(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets)
      : rows_(static_cast<double>(features.rows())),
        mean_(features.colwise().mean()),
        intercept_(targets.colwise().mean()) {
    const Eigen::MatrixXd centred = features.rowwise() - mean_;
    SymmetricParts parts = SymmetricEigen(centred.transpose() * centred);
    vectors_ = std::move(parts.vectors);
    values_ = parts.values.cwiseMax(0.0);
    projected_ = vectors_.transpose() * (centred.transpose() * (targets.rowwise() - intercept_));
  }

  Ridge With(double penalty) const {
    const Eigen::VectorXd shrink = (values_.array() + rows_ * penalty).inverse();
    return {.mean = mean_,
            .intercept = intercept_,
            .slope = vectors_ * (shrink.asDiagonal() * projected_),
            .penalty = penalty};
  }

 private:
  double rows_;
  Eigen::RowVectorXd mean_;
  Eigen::RowVectorXd intercept_;
  Eigen::MatrixXd vectors_;
  Eigen::VectorXd values_;
  Eigen::MatrixXd projected_;
};

std::vector<int> FoldOfRow(std::span<const int> group) {
  const std::set<int> numbers(group.begin(), group.end());
  std::vector<int> fold(group.size());
  for (std::size_t i = 0; i < group.size(); ++i) {
    const auto position =
        numbers.size() > 1 ? static_cast<std::size_t>(std::distance(numbers.begin(), numbers.find(group[i])))
                           : i * kFolds / group.size();
    fold[i] = static_cast<int>(position % kFolds);
  }
  return fold;
}

}  // namespace

Eigen::MatrixXd Ridge::Predict(const Eigen::MatrixXd& features) const {
  return ((features.rowwise() - mean) * slope).rowwise() + intercept;
}

Ridge FitRidge(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets, std::span<const int> group) {
  if (features.rows() != targets.rows() || group.size() != static_cast<std::size_t>(features.rows()) ||
      features.rows() < kFolds) {
    throw std::invalid_argument(
        fmt::format("features has {} rows, targets {}, group {} (expected the same, at least {})",
                    features.rows(), targets.rows(), group.size(), kFolds));
  }
  const std::vector<int> fold_of_row = FoldOfRow(group);
  const Eigen::RowVectorXd variance = (targets.rowwise() - targets.colwise().mean())
                                          .array()
                                          .square()
                                          .colwise()
                                          .mean()
                                          .max(std::numeric_limits<double>::min());
  std::vector<double> error(std::size(kPenalties), 0.0);
  for (int fold = 0; fold < kFolds; ++fold) {
    std::vector<Eigen::Index> seen;
    std::vector<Eigen::Index> unseen;
    for (std::size_t i = 0; i < fold_of_row.size(); ++i) {
      (fold_of_row[i] == fold ? unseen : seen).push_back(static_cast<Eigen::Index>(i));
    }
    if (seen.empty() || unseen.empty()) continue;
    const PenalizedFit fit(features(seen, Eigen::all), targets(seen, Eigen::all));
    const Eigen::MatrixXd apart = features(unseen, Eigen::all);
    const Eigen::MatrixXd truth = targets(unseen, Eigen::all);
    for (std::size_t k = 0; k < std::size(kPenalties); ++k) {
      const Eigen::MatrixXd off = truth - fit.With(kPenalties[k]).Predict(apart);
      error[k] += (off.array().square().rowwise() / variance.array()).sum();
    }
  }
  const auto best = static_cast<std::size_t>(std::min_element(error.begin(), error.end()) - error.begin());
  return PenalizedFit(features, targets).With(kPenalties[best]);
}

}  // namespace strainwave::analysis::prediction
