// SPDX-License-Identifier: Apache-2.0
#include "analysis/lost_motion.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "analysis/angle_weights.h"
#include "analysis/units.h"

namespace strainwave::analysis {
namespace {

double Remainder(double angle_rad) {
  const double remainder = std::fmod(angle_rad, kTwoPi);
  return remainder < 0.0 ? remainder + kTwoPi : remainder;
}

// One turn of error, sorted by angle, with a copy of the first sample a turn later.
class Turn {
 public:
  explicit Turn(const SweepError& sweep) {
    for (std::size_t i = 0; i < sweep.error_rad.size(); ++i) {
      points_.emplace_back(Remainder(sweep.output_angle_rad[i]), sweep.error_rad[i]);
    }
    std::stable_sort(points_.begin(), points_.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<double> angle_rad;
    for (const auto& point : points_) angle_rad.push_back(point.first);
    longest_gap_rad_ = 3.0 * UsualStep(angle_rad);
    points_.emplace_back(points_.front().first + kTwoPi, points_.front().second);
  }

  // None across a gap of more than three usual steps: the sweep was not there.
  std::optional<double> At(double angle_rad) const {
    double angle = Remainder(angle_rad);
    if (angle < points_.front().first) {
      angle += kTwoPi;
    }
    auto right = std::upper_bound(points_.begin(), points_.end(), angle,
                                  [](double value, const auto& point) { return value < point.first; });
    if (right == points_.end()) {
      --right;
    }
    const auto& [left_rad, left_error] = *std::prev(right);
    const double gap_rad = right->first - left_rad;
    if (gap_rad > longest_gap_rad_) {
      return std::nullopt;
    }
    const double share = gap_rad > 0.0 ? (angle - left_rad) / gap_rad : 0.0;
    return left_error + share * (right->second - left_error);
  }

 private:
  std::vector<std::pair<double, double>> points_;
  double longest_gap_rad_{};
};

struct Sum {
  double total{};
  double weight{};
};

Sum DifferencesAtAngles(const SweepError& at, const SweepError& other) {
  const Turn turn(other);
  const std::vector<double> weights = AngleWeights(at.output_angle_rad);
  Sum sum;
  for (std::size_t i = 0; i < at.error_rad.size(); ++i) {
    if (const auto there = turn.At(at.output_angle_rad[i])) {
      sum.total += weights[i] * (at.error_rad[i] - *there);
      sum.weight += weights[i];
    }
  }
  return sum;
}

}  // namespace

std::optional<double> MeanDifferenceAtEqualAngle(const SweepError& first, const SweepError& second) {
  const Sum forward = DifferencesAtAngles(first, second);
  const Sum backward = DifferencesAtAngles(second, first);
  if (!(forward.weight > 0.0) || !(backward.weight > 0.0)) {
    return std::nullopt;
  }
  return 0.5 * (forward.total / forward.weight - backward.total / backward.weight);
}

}  // namespace strainwave::analysis
