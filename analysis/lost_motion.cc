// SPDX-License-Identifier: Apache-2.0
#include "analysis/lost_motion.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

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
    points_.emplace_back(points_.front().first + kTwoPi, points_.front().second);
    std::size_t distinct = 0;
    for (std::size_t i = 1; i < points_.size(); ++i) {
      distinct += points_[i].first > points_[i - 1].first ? 1 : 0;
    }
    longest_gap_rad_ = 3.0 * kTwoPi / static_cast<double>(distinct);
  }

  // None across a gap of more than three mean steps: the sweep was not there.
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
  std::size_t count{};
};

Sum DifferencesAtAngles(const SweepError& at, const SweepError& other) {
  const Turn turn(other);
  Sum sum;
  for (std::size_t i = 0; i < at.error_rad.size(); ++i) {
    if (const auto there = turn.At(at.output_angle_rad[i])) {
      sum.total += at.error_rad[i] - *there;
      ++sum.count;
    }
  }
  return sum;
}

}  // namespace

std::optional<double> MeanDifferenceAtEqualAngle(const SweepError& first, const SweepError& second) {
  const Sum forward = DifferencesAtAngles(first, second);
  const Sum backward = DifferencesAtAngles(second, first);
  if (forward.count == 0 || backward.count == 0) {
    return std::nullopt;
  }
  return 0.5 * (forward.total / static_cast<double>(forward.count) -
                backward.total / static_cast<double>(backward.count));
}

}  // namespace strainwave::analysis
