// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/reversal_smoothing.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/decompositions.h"
#include "analysis/diagnosis/motion/grid.h"
#include "analysis/diagnosis/motion/kernel.h"
#include "analysis/diagnosis/study.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kNarrowest = 2e-4;  // of the 95 % quantile of the speed
constexpr double kWidest = 0.026;    // of it

constexpr double kWidthOfNoise = 3.0;  // standard deviations
constexpr double kAboveNoise = 4.0;    // of the smoothed position: shortest way of presliding
// The longest way of presliding that is no backlash or wind-up: of the travel, and of a turning axis at most
// a few degrees (docs/effects.md#e12).
constexpr double kLongestWay = 0.01;
constexpr double kLongestWay_rad = 0.05;
constexpr double kShortestWay = 1e-4;           // of that
const double kWaysApart = std::numbers::sqrt2;  // ratio
// In −2 log-likelihood. Axes in closed loop whose friction bends gained 17 to 4000 (tests/blind/generators,
// lugre_cascade_axis, seed 5302).
constexpr double kClearPresliding = 16.0;

void SetReversalSmoothing(MotionGrid& grid, const ReversalSmoothing& reversal_smoothing) {
  grid.reversal_smoothing = reversal_smoothing;
  grid.direction = DirectionBy(reversal_smoothing, grid, 0.0);
  grid.nominal.col(2) = grid.Project(grid.direction);
}

// Standard deviation of the noise of the points' positions.
double PointNoise(const MotionGrid& grid) {
  return NoiseGain(MakeKernel(grid.path_sigma_s, grid.segments.front().step_s, 0)) * grid.position_noise;
}

// The path less what may be its noise, which to and fro would take a gradual bend back: moved only as far as
// it has to be to stay within a few standard deviations (a play).
std::vector<double> WithoutNoise(const MotionGrid& grid) {
  const double width = kWidthOfNoise * PointNoise(grid);
  std::vector<double> path(grid.position);
  for (const MotionGrid::Segment& segment : grid.segments) {
    for (std::size_t i = segment.first + 1; i < segment.first + segment.count; ++i)
      path[i] = std::clamp(path[i - 1], grid.position[i] - width, grid.position[i] + width);
  }
  return path;
}

// Bend of an element along the path, over its largest.
std::vector<double> BendAlong(const MotionGrid& grid, std::span<const double> path,
                              const PreslidingElement& element) {
  std::vector<double> bend(grid.position.size());
  const double moves = kMoving * QuantileOfMagnitude(grid.velocity, 0.95);
  for (const MotionGrid::Segment& segment : grid.segments) {
    const double first = grid.velocity[segment.first];
    double now = std::abs(first) > moves ? std::copysign(1.0, first) : 0.0;
    for (std::size_t i = segment.first; i < segment.first + segment.count; ++i) {
      if (i > segment.first) {
        const double moved = (path[i] - path[i - 1]) / element.way;
        const double end = std::copysign(1.0, moved);
        now = element.gradual ? end - (end - now) * std::exp(-std::abs(moved))
                              : std::clamp(now + moved, -1.0, 1.0);
      }
      bend[i] = now;
    }
  }
  return bend;
}

// More is no presliding.
double LongestWay(const MotionGrid& grid) {
  const auto [low, high] = std::ranges::minmax(grid.position);
  return std::min(kLongestWay * (high - low), grid.linear ? kUnlimited : kLongestWay_rad);
}

// Elements that the positions can show, from short to long, of both sorts.
std::vector<PreslidingElement> ElementsOf(const MotionGrid& grid) {
  const double longest = LongestWay(grid);
  std::vector<PreslidingElement> elements;
  for (double way = std::max(kAboveNoise * PointNoise(grid), kShortestWay * longest); way < longest;
       way *= kWaysApart) {
    for (const bool gradual : {false, true}) elements.push_back({way, 0.0, gradual});
  }
  return elements;
}

// The elements that leave least of the torque; none where they take none.
// @param basis  orthonormal, of what else may be in the torque; `rest`, what that leaves of it: both weighted
ReversalSmoothing PreslidingOf(const MotionGrid& grid, const Eigen::MatrixXd& basis,
                               const Eigen::VectorXd& rest, double delay_s) {
  std::vector<PreslidingElement> elements = ElementsOf(grid);
  if (elements.empty()) return {};
  Eigen::MatrixXd columns(rest.size(), static_cast<Eigen::Index>(elements.size()));
  const std::vector<double> path = WithoutNoise(grid);
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    const std::vector<double> bend = BendAlong(grid, path, elements[static_cast<std::size_t>(k)]);
    columns.col(k) = grid.Weighted(grid.Project(grid.Later(bend, delay_s)));
  }
  columns -= basis * (basis.transpose() * columns).eval();
  const Eigen::VectorXd forces = NonNegativeLeastSquares(columns, rest);
  for (Eigen::Index k = 0; k < columns.cols(); ++k)
    elements[static_cast<std::size_t>(k)].share = forces(k) > 0.0 ? forces(k) / forces.sum() : 0.0;
  std::erase_if(elements, [](const PreslidingElement& element) { return element.share == 0.0; });
  ReversalSmoothing presliding;
  presliding.elements = std::move(elements);
  return presliding;
}

}  // namespace

double MeanWay(const ReversalSmoothing& reversal_smoothing) {
  double way = 0.0;
  for (const PreslidingElement& element : reversal_smoothing.elements) way += element.share * element.way;
  return way;
}

std::vector<double> DirectionLater(const MotionGrid& grid, double shift_s) {
  // What bends along the path is only moved in time: the path is gone through once, not for each shift.
  return grid.reversal_smoothing.elements.empty() ? DirectionBy(grid.reversal_smoothing, grid, shift_s)
                                                  : grid.Later(grid.direction, shift_s);
}

std::vector<double> DirectionBy(const ReversalSmoothing& reversal_smoothing, const MotionGrid& grid,
                                double shift_s) {
  // Between two points a sign of velocity turns faster than points can be shifted.
  if (reversal_smoothing.elements.empty())
    return reversal_smoothing.SignsOf(shift_s == 0.0 ? grid.velocity : grid.Later(grid.velocity, shift_s));
  std::vector<double> direction(grid.position.size(), 0.0);
  const std::vector<double> path = WithoutNoise(grid);
  for (const PreslidingElement& element : reversal_smoothing.elements) {
    const std::vector<double> bend = BendAlong(grid, path, element);
    for (std::size_t i = 0; i < bend.size(); ++i) direction[i] += element.share * bend[i];
  }
  return shift_s == 0.0 ? direction : grid.Later(direction, shift_s);
}

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
  const Eigen::MatrixXd usual = UsualEffects(grid, PathLater(grid, delay_s));
  Eigen::MatrixXd others(grid.nominal.rows(), grid.nominal.cols() - 1 + usual.cols());
  const std::vector<double> later = grid.Later(grid.velocity, delay_s);
  others << grid.ProjectPassed(grid.Later(grid.passed_acceleration, delay_s)), grid.ProjectPassed(later),
      grid.nominal.rightCols(grid.nominal.cols() - 3), usual;
  const Eigen::MatrixXd basis = OrthonormalBasis(grid.Weighted(others));
  const Eigen::VectorXd measured = grid.Weighted(torque);
  const Eigen::VectorXd rest = measured - basis * (basis.transpose() * measured);
  const auto left_by = [&](const ReversalSmoothing& reversal_smoothing) {
    const Eigen::VectorXd column =
        grid.Weighted(grid.Project(DirectionBy(reversal_smoothing, grid, delay_s)));
    const Eigen::VectorXd beside = column - basis * (basis.transpose() * column);
    const double along = beside.dot(rest);
    return rest.squaredNorm() - along * along / std::max(beside.squaredNorm(), 1e-300);
  };
  ReversalSmoothing best{.width = grid.velocity_noise};
  double least = left_by(best);
  std::vector<std::pair<double, ReversalSmoothing>> tried{{least, best}};
  const auto try_reversal_smoothing = [&](const ReversalSmoothing& other, double clearly) {
    if (other.width <= grid.velocity_noise && other.elements.empty()) return;
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
  if (const ReversalSmoothing presliding = PreslidingOf(grid, basis, rest, delay_s);
      !presliding.elements.empty() && MeanWay(presliding) < 0.5 * LongestWay(grid))
    try_reversal_smoothing(presliding, kClearPresliding);
  SetReversalSmoothing(grid, best);
  std::vector<ReversalSmoothing> open;
  for (const auto& [left, reversal_smoothing] : tried) {
    if (static_cast<double>(grid.rows()) * std::log(left / least) < kClearDetail)
      open.push_back(reversal_smoothing);
  }
  return open;
}

}  // namespace strainwave::analysis::diagnosis
