// SPDX-License-Identifier: Apache-2.0
#include "analysis/loop_branches.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/isotonic.h"
#include "analysis/linear_regression.h"

namespace strainwave::analysis {
namespace {

void MakeMonotone(std::span<const double> signal, bool rising, std::span<double> result) {
  std::size_t i = 0;
  for (const Pool& pool : PoolAdjacentViolators(signal, {}, rising)) {
    for (std::size_t k = 0; k < pool.count; ++k) result[i++] = pool.Mean();
  }
}

// Whether the branch passes the level between two samples that lie several times further apart than any
// others of it: what it did there is not in the record.
bool PassesInAGap(std::span<const double> torque_Nm, const Branch& branch, double level_Nm) {
  constexpr double kClearly = 3.0;
  double passing_Nm = 0.0;
  double other_Nm = 0.0;
  for (std::size_t i = branch.first + 1; i <= branch.last; ++i) {
    const bool passes = (torque_Nm[i - 1] - level_Nm) * (torque_Nm[i] - level_Nm) <= 0.0;
    double& largest_Nm = passes ? passing_Nm : other_Nm;
    largest_Nm = std::max(largest_Nm, std::abs(torque_Nm[i] - torque_Nm[i - 1]));
  }
  return passing_Nm > kClearly * other_Nm;
}

}  // namespace

std::vector<Branch> SplitBranches(std::span<const double> signal, double threshold) {
  std::vector<Branch> branches;
  if (signal.size() < 2) {
    return branches;
  }
  std::size_t start = 0;
  std::size_t lowest = 0;
  std::size_t highest = 0;
  int direction = 0;  // not known until the signal has moved by more than the threshold
  for (std::size_t i = 1; i < signal.size(); ++i) {
    if (signal[i] > signal[highest]) {
      highest = i;
    }
    if (signal[i] < signal[lowest]) {
      lowest = i;
    }
    const bool rose = signal[i] - signal[lowest] > threshold;
    const bool fell = signal[highest] - signal[i] > threshold;
    if (direction <= 0 && rose) {
      if (direction < 0) {
        branches.push_back({start, lowest, false});
        start = lowest;
      }
      direction = 1;
      highest = i;
    } else if (direction >= 0 && fell) {
      if (direction > 0) {
        branches.push_back({start, highest, true});
        start = highest;
      }
      direction = -1;
      lowest = i;
    }
  }
  const bool rising = direction == 0 ? signal.back() >= signal.front() : direction > 0;
  branches.push_back({start, signal.size() - 1, rising});
  return branches;
}

std::vector<double> MonotoneWithinBranches(std::span<const double> signal, std::span<const Branch> branches) {
  std::vector<double> result(signal.begin(), signal.end());
  for (const Branch& branch : branches) {
    // The sample of the reversal belongs to the branch that it ends.
    const std::size_t first = branch.first == 0 ? 0 : branch.first + 1;
    if (first > branch.last) {
      continue;
    }
    const std::size_t count = branch.last + 1 - first;
    MakeMonotone(signal.subspan(first, count), branch.rising, std::span(result).subspan(first, count));
  }
  return result;
}

std::optional<Estimate> TwistAtTorque(std::span<const double> torque_Nm, std::span<const double> twist_rad,
                                      const Branch& branch, double level_Nm, double window_Nm,
                                      double reach_Nm) {
  constexpr std::size_t kMinSamples = 4;
  // Of the window: samples that stand closer together, as those of a hold do, have no slope of their own.
  constexpr double kLeastSpread = 0.2;
  const auto [low, high] = std::minmax(torque_Nm[branch.first], torque_Nm[branch.last]);
  const std::size_t all = branch.last - branch.first + 1;
  if (level_Nm < low - reach_Nm || level_Nm > high + reach_Nm || all < kMinSamples ||
      PassesInAGap(torque_Nm, branch, level_Nm)) {
    return std::nullopt;
  }
  std::vector<std::size_t> near;
  double spread_Nm = 0.0;
  const auto have_slope = [&] { return near.size() >= kMinSamples && spread_Nm >= kLeastSpread * window_Nm; };
  for (double window = window_Nm; near.size() < all && !have_slope(); window *= 1.5) {
    near.clear();
    double least_Nm = std::numeric_limits<double>::infinity();
    double most_Nm = -least_Nm;
    for (std::size_t i = branch.first; i <= branch.last; ++i) {
      if (std::abs(torque_Nm[i] - level_Nm) > window) continue;
      near.push_back(i);
      least_Nm = std::min(least_Nm, torque_Nm[i]);
      most_Nm = std::max(most_Nm, torque_Nm[i]);
    }
    spread_Nm = most_Nm - least_Nm;
  }
  if (!have_slope()) return std::nullopt;
  const auto n = static_cast<Eigen::Index>(near.size());
  Eigen::MatrixXd design(n, 2);
  Eigen::VectorXd twist(n);
  for (Eigen::Index row = 0; row < n; ++row) {
    const std::size_t i = near[static_cast<std::size_t>(row)];
    design(row, 0) = 1.0;
    design(row, 1) = torque_Nm[i] - level_Nm;
    twist(row) = twist_rad[i];
  }
  const LinearFit line =
      FitLinear(design, twist, n < 20 ? ErrorModel::kIndependent : ErrorModel::kAutocorrelated);
  return Estimate{line.coefficients(0), line.StandardError(0)};
}

}  // namespace strainwave::analysis
