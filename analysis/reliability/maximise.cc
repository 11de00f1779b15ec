// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/maximise.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

namespace strainwave::analysis::reliability {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr int kMostSteps = 200;
constexpr double kLongestStep = 2.0;  // of one coordinate, a logarithm
// Twice what a step would gain: below it the step is the last, and no value is compared with one that differs
// by rounding alone.
constexpr double kDecrementAtRest = 1e-9;
constexpr double kNearRest = 1e-4;
constexpr double kNoGain = 1e-9;

// −H⁻¹ g with the ridge that makes −H positive definite.
VectorXd AscentStep(const VectorXd& gradient, const MatrixXd& hessian) {
  MatrixXd curvature = -hessian;
  const double size = std::max(curvature.diagonal().cwiseAbs().maxCoeff(), 1e-12);
  for (double ridge = 0.0;; ridge = ridge == 0.0 ? 1e-6 * size : 10.0 * ridge) {
    const MatrixXd with_ridge = curvature + ridge * MatrixXd::Identity(curvature.rows(), curvature.cols());
    const Eigen::LLT<MatrixXd> llt(with_ridge);
    if (llt.info() == Eigen::Success) {
      const VectorXd step = llt.solve(gradient);
      if (step.allFinite()) return step;
    }
    if (ridge > 1e9 * size) return gradient / size;
  }
}

}  // namespace

LogLikelihood ByDifferences(std::function<double(const VectorXd&)> value, double step) {
  return [value = std::move(value), step](const VectorXd& at) {
    const Index n = at.size();
    Evaluation e{value(at), VectorXd::Zero(n), MatrixXd::Zero(n, n)};
    if (!std::isfinite(e.value)) return e;
    VectorXd x = at;
    const auto moved = [&](Index i, double by_i, Index j, double by_j) {
      x = at;
      x(i) += by_i * step;
      x(j) += by_j * step;
      return value(x);
    };
    for (Index i = 0; i < n; ++i) {
      const double up = moved(i, 1.0, i, 0.0);
      const double down = moved(i, -1.0, i, 0.0);
      e.gradient(i) = (up - down) / (2.0 * step);
      e.hessian(i, i) = (up - 2.0 * e.value + down) / (step * step);
      for (Index j = 0; j < i; ++j) {
        e.hessian(i, j) =
            (moved(i, 1, j, 1) - moved(i, 1, j, -1) - moved(i, -1, j, 1) + moved(i, -1, j, -1)) /
            (4.0 * step * step);
        e.hessian(j, i) = e.hessian(i, j);
      }
    }
    return e;
  };
}

std::optional<Maximum> Maximise(const LogLikelihood& function, VectorXd start,
                                const std::vector<Index>& fixed) {
  std::vector<Index> open;
  for (Index i = 0; i < start.size(); ++i) {
    if (std::ranges::find(fixed, i) == fixed.end()) open.push_back(i);
  }
  Maximum now{std::move(start), {}};
  now.evaluation = function(now.at);
  if (!std::isfinite(now.evaluation.value)) return std::nullopt;
  if (open.empty()) return now;
  for (int k = 0; k < kMostSteps; ++k) {
    const VectorXd gradient = now.evaluation.gradient(open);
    VectorXd step = AscentStep(gradient, now.evaluation.hessian(open, open));
    if (!step.allFinite()) return std::nullopt;
    const double decrement = std::abs(gradient.dot(step));
    if (decrement < kDecrementAtRest) {
      now.at(open) += step;
      now.evaluation.value += 0.5 * decrement;
      now.evaluation.gradient(open).setZero();
      return now;
    }
    const double longest = step.cwiseAbs().maxCoeff();
    if (longest > kLongestStep) step *= kLongestStep / longest;
    bool grew = false;
    for (int halved = 0; halved < 60 && !grew; ++halved, step *= 0.5) {
      Maximum next{now.at, {}};
      next.at(open) += step;
      next.evaluation = function(next.at);
      const double gain = next.evaluation.value - now.evaluation.value;
      if (!std::isfinite(next.evaluation.value) || !next.evaluation.gradient.allFinite() ||
          !next.evaluation.hessian.allFinite() || !(gain >= 0.0))
        continue;
      grew = true;
      now = std::move(next);
      // Differences are rough where coordinates are nearly alike: nothing is gained any more.
      if (gain < kNoGain && decrement < kNearRest) return now;
    }
    // Rounding alone is left.
    if (!grew) return decrement < kNearRest ? std::optional(now) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace strainwave::analysis::reliability
