// SPDX-License-Identifier: Apache-2.0
#include "analysis/health/what_if.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>

#include "analysis/explanation/shapley.h"
#include "analysis/interval_95.h"
#include "analysis/statistics/convex_hull.h"

namespace strainwave::analysis::health {
namespace {

// Sums of corners of the box, in the system's index.
class Corners {
 public:
  Corners(const statistics::Posterior& posterior, const SystemScale& scale)
      : mean_((posterior.mean.array() - scale.healthy) * scale.factor()),
        covariance_(posterior.covariance * (scale.factor() * scale.factor())) {}

  Eigen::Index count() const { return mean_.size(); }
  Bounded Sum(const Eigen::VectorXd& weights) const {
    const double value = weights.dot(mean_);
    const double half = kStandardErrorsOf95 * std::sqrt(std::max(0.0, weights.dot(covariance_ * weights)));
    return {value, value - half, value + half};
  }

 private:
  Eigen::VectorXd mean_;
  Eigen::MatrixXd covariance_;
};

Eigen::VectorXd Difference(Eigen::Index count, Eigen::Index plus, Eigen::Index minus) {
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(count);
  weights(plus) += 1.0;
  weights(minus) -= 1.0;
  return weights;
}

// The weight of each corner in the Shapley value of a component.
Eigen::VectorXd ShapleyWeights(std::size_t components, std::size_t component) {
  const Eigen::Index count = Eigen::Index{1} << components;
  Eigen::VectorXd weights(count);
  for (Eigen::Index corner = 0; corner < count; ++corner) {
    const auto coalition = static_cast<explanation::Coalition>(corner);
    const auto size = static_cast<std::size_t>(std::popcount(coalition));
    const bool within = (coalition >> component & 1U) != 0;
    weights(corner) = within ? explanation::ShapleyWeight(components, size - 1)
                             : -explanation::ShapleyWeight(components, size);
  }
  return weights;
}

}  // namespace

std::vector<SystemAt> SystemsAt(const statistics::GaussianProcess& surface, const SystemScale& scale,
                                const Eigen::MatrixXd& points, IntervalOf interval) {
  const statistics::Posterior posterior = surface.At(points);
  const double noise = interval == IntervalOf::kMeasurement ? surface.parameters().noise_variance : 0.0;
  std::vector<SystemAt> systems;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const double value = scale.Index(posterior.mean(i));
    const double half = kStandardErrorsOf95 * std::abs(scale.factor()) *
                        std::sqrt(std::max(0.0, posterior.covariance(i, i)) + noise);
    systems.push_back({{value, value - half, value + half},
                       statistics::DistanceFromHull(surface.data().points, points.row(i)) > 0.0});
  }
  return systems;
}

WhatIf AskWhatIf(const statistics::GaussianProcess& surface, const SystemScale& scale,
                 const Eigen::VectorXd& state, IntervalOf interval) {
  const Eigen::Index n = state.size();
  if (n != surface.data().points.cols() || n < 1 || n > kMostWhatIfComponents)
    throw std::invalid_argument(
        fmt::format("{} components for a surface of {} (expected the same, {} at most)", n,
                    surface.data().points.cols(), kMostWhatIfComponents));
  // Corner bits: component c as it is (1) or as new (0).
  const Eigen::Index count = Eigen::Index{1} << n;
  Eigen::MatrixXd points(count, n);
  for (Eigen::Index corner = 0; corner < count; ++corner) {
    for (Eigen::Index c = 0; c < n; ++c) points(corner, c) = (corner >> c & 1) != 0 ? state(c) : 0.0;
  }
  const std::vector<SystemAt> systems = SystemsAt(surface, scale, points, interval);
  const Corners corners(surface.At(points), scale);
  const Eigen::Index all = count - 1;
  WhatIf result;
  result.system = systems[static_cast<std::size_t>(all)];
  // A share, as the others: of the surface.
  Eigen::VectorXd none = Eigen::VectorXd::Zero(count);
  none(0) = 1.0;
  result.baseline = {corners.Sum(none), systems.front().extrapolated};
  Eigen::VectorXd left = Difference(count, all, 0);
  std::vector<Eigen::VectorXd> gains;
  for (Eigen::Index c = 0; c < n; ++c) {
    const Eigen::Index own = Eigen::Index{1} << c;
    result.restored.push_back(systems[static_cast<std::size_t>(all - own)]);
    gains.push_back(Difference(count, all, all - own));
    result.gain.push_back(corners.Sum(gains.back()));
    const Eigen::VectorXd alone = Difference(count, own, 0);
    result.alone.push_back(corners.Sum(alone));
    left -= alone;
    result.shapley.push_back(
        corners.Sum(ShapleyWeights(static_cast<std::size_t>(n), static_cast<std::size_t>(c))));
  }
  result.interaction = corners.Sum(left);
  result.ranking.resize(static_cast<std::size_t>(n));
  std::iota(result.ranking.begin(), result.ranking.end(), std::size_t{0});
  std::ranges::stable_sort(result.ranking, [&](std::size_t a, std::size_t b) {
    return result.gain[a].value > result.gain[b].value;
  });
  for (std::size_t rank = 0; rank + 1 < result.ranking.size(); ++rank) {
    const Bounded apart = corners.Sum(gains[result.ranking[rank]] - gains[result.ranking[rank + 1]]);
    result.tied_with_next.push_back(apart.low <= 0.0);
  }
  result.extrapolated = std::ranges::any_of(systems, &SystemAt::extrapolated);
  return result;
}

}  // namespace strainwave::analysis::health
