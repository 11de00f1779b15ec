// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/reversal_smoothing.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/decompositions.h"
#include "analysis/diagnosis/motion/grid.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kClearDetail =
    12.0;  // in −2 log-likelihood: what a detail of the nominal model has to bring
constexpr double kNarrowest = 2e-4;  // of the 95 % quantile of the speed
constexpr double kWidest = 0.026;    // of it

void SetReversalSmoothing(MotionGrid& grid, const ReversalSmoothing& reversal_smoothing) {
  grid.reversal_smoothing = reversal_smoothing;
  grid.direction = reversal_smoothing.SignsOf(grid.velocity);
  grid.nominal.col(2) = grid.Project(grid.direction);
}

}  // namespace

std::vector<double> ReversalSmoothing::SignsOf(std::span<const double> velocities) const {
  std::vector<double> signs(velocities.size());
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    const double v = velocities[i];
    if (!(width > 0.0)) {
      signs[i] = static_cast<double>((v > 0.0) - (v < 0.0));
    } else {
      // Of one width where they are as steep at rest.
      signs[i] = hyperbolic ? std::tanh(std::sqrt(2.0 / std::numbers::pi) * v / width)
                            : std::erf(v / (std::sqrt(2.0) * width));
    }
  }
  return signs;
}

std::vector<ReversalSmoothing> ChooseReversalSmoothing(MotionGrid& grid, const Eigen::VectorXd& torque,
                                                       double delay_s) {
  // An axis that never turns shows none: friction that falls with speed would pass for one.
  if (grid.Reversals() == 0) {
    SetReversalSmoothing(grid, {.width = grid.velocity_noise});
    return {};
  }
  // What no width changes is projected out once.
  const Eigen::MatrixXd usual = UsualEffects(grid);
  Eigen::MatrixXd others(grid.nominal.rows(), grid.nominal.cols() - 1 + usual.cols());
  const std::vector<double> later = grid.Later(grid.velocity, delay_s);
  others << grid.ProjectPassed(grid.Later(grid.passed_acceleration, delay_s)), grid.ProjectPassed(later),
      grid.nominal.rightCols(grid.nominal.cols() - 3), usual;
  const Eigen::MatrixXd basis = OrthonormalBasis(grid.Weighted(others));
  const Eigen::VectorXd measured = grid.Weighted(torque);
  const Eigen::VectorXd rest = measured - basis * (basis.transpose() * measured);
  const auto left_by = [&](const ReversalSmoothing& reversal_smoothing) {
    const Eigen::VectorXd column = grid.Weighted(grid.Project(reversal_smoothing.SignsOf(later)));
    const Eigen::VectorXd beside = column - basis * (basis.transpose() * column);
    const double along = beside.dot(rest);
    return rest.squaredNorm() - along * along / std::max(beside.squaredNorm(), 1e-300);
  };
  ReversalSmoothing best{.width = grid.velocity_noise};
  double least = left_by(best);
  std::vector<std::pair<double, ReversalSmoothing>> tried{{least, best}};
  const auto try_reversal_smoothing = [&](const ReversalSmoothing& other, double clearly) {
    if (other.width <= grid.velocity_noise) return;
    const double now = left_by(other);
    tried.emplace_back(now, other);
    if (static_cast<double>(grid.rows()) * std::log(least / now) > clearly) {
      least = now;
      best = other;
    }
  };
  const double speed = QuantileOfMagnitude(grid.velocity, 0.95);
  for (double share = kNarrowest; share < kWidest; share *= 2.0) {
    for (const bool hyperbolic : {false, true})
      try_reversal_smoothing({.width = share * speed, .hyperbolic = hyperbolic},
                             best.width > grid.velocity_noise ? 0.0 : kClearDetail);
  }
  if (best.width > grid.velocity_noise) {
    for (double ratio = std::sqrt(2.0); ratio > 1.02; ratio = std::sqrt(ratio)) {
      const ReversalSmoothing centre = best;
      for (const bool hyperbolic : {false, true}) {
        for (const double width : {centre.width * ratio, centre.width, centre.width / ratio})
          try_reversal_smoothing({.width = width, .hyperbolic = hyperbolic}, 0.0);
      }
    }
  }
  SetReversalSmoothing(grid, best);
  std::vector<ReversalSmoothing> open;
  for (const auto& [left, reversal_smoothing] : tried) {
    if (static_cast<double>(grid.rows()) * std::log(left / least) < kClearDetail)
      open.push_back(reversal_smoothing);
  }
  return open;
}

}  // namespace strainwave::analysis::diagnosis
