// SPDX-License-Identifier: Apache-2.0
#include "analysis/angle_weights.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "analysis/arguments.h"
#include "analysis/units.h"

namespace strainwave::analysis {

namespace {

// What the last sample of a revolution that closes lacks of it; 0 where it lacks more than the longest step.
double ClosingAngle(std::span<const double> angle_rad) {
  RequireAtLeast("angle_rad", angle_rad, 2);
  const double travel_rad = angle_rad.back() - angle_rad.front();
  if (travel_rad == 0.0) throw std::invalid_argument("angle_rad ends where it begins (expected a sweep)");
  const double direction = std::copysign(1.0, travel_rad);
  double longest_rad = 0.0;
  for (std::size_t i = 1; i < angle_rad.size(); ++i)
    longest_rad = std::max(longest_rad, direction * (angle_rad[i] - angle_rad[i - 1]));
  const double missing_rad = kTwoPi - std::abs(travel_rad);
  return missing_rad > 0.0 && missing_rad <= 1.5 * longest_rad ? direction * missing_rad : 0.0;
}

}  // namespace

double WeightedAngle(std::span<const double> angle_rad) {
  const double closing_rad = ClosingAngle(angle_rad);
  return angle_rad.back() - angle_rad.front() + closing_rad;
}

std::vector<double> AngleWeights(std::span<const double> angle_rad) {
  const double closing_rad = ClosingAngle(angle_rad);
  const double whole_rad = angle_rad.back() - angle_rad.front() + closing_rad;
  std::vector<double> weights(angle_rad.size());
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double before_rad = i > 0 ? angle_rad[i] - angle_rad[i - 1] : closing_rad;
    const double after_rad = i + 1 < weights.size() ? angle_rad[i + 1] - angle_rad[i] : closing_rad;
    weights[i] = 0.5 * (before_rad + after_rad) / whole_rad;
  }
  return weights;
}

double UsualStep(std::span<const double> angle_rad) {
  std::vector<double> steps;
  double way_rad = 0.0;
  for (std::size_t i = 1; i < angle_rad.size(); ++i) {
    steps.push_back(std::abs(angle_rad[i] - angle_rad[i - 1]));
    way_rad += steps.back();
  }
  std::sort(steps.begin(), steps.end(), std::greater<>());
  double done_rad = 0.0;
  for (const double step_rad : steps) {
    done_rad += step_rad;
    if (2.0 * done_rad >= way_rad) return step_rad;
  }
  return 0.0;
}

}  // namespace strainwave::analysis
