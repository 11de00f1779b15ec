// SPDX-License-Identifier: Apache-2.0
#include "analysis/stiffness_start.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "analysis/decompositions.h"

namespace strainwave::analysis {
namespace {

constexpr std::size_t kThinnedSamples = 800;
constexpr int kYieldTwists = 14;  // grid points, from 0.2 % to 40 % of the twist's range
constexpr double kSmallestYield = 0.002;
constexpr double kLargestYield = 0.4;
constexpr std::size_t kStarts = 2;

// Twists of the mid-line at the knees, from its centre.
struct MidLine {
  double centre_rad{};
  double knee1_rad{};
  double knee2_rad{};
};

std::optional<double> MeanTwistAt(const PreparedLoop& loop, double level_Nm) {
  double sums[2] = {};
  int counts[2] = {};
  for (const Branch& branch : loop.branches) {
    const double window_Nm = 0.1 * loop.torques.t1_Nm;
    if (auto twist =
            TwistAtTorque(loop.torque_Nm, loop.twist_rad, branch, level_Nm, window_Nm, 0.1 * window_Nm)) {
      sums[branch.rising ? 1 : 0] += twist->value;
      ++counts[branch.rising ? 1 : 0];
    }
  }
  if (counts[0] + counts[1] == 0) {
    return std::nullopt;
  }
  if (counts[0] == 0 || counts[1] == 0) {
    return (sums[0] + sums[1]) / (counts[0] + counts[1]);
  }
  return 0.5 * (sums[0] / counts[0] + sums[1] / counts[1]);
}

MidLine FindMidLine(const PreparedLoop& loop) {
  const auto [low, high] = std::minmax_element(loop.twist_rad.begin(), loop.twist_rad.end());
  const auto [low_Nm, high_Nm] = std::minmax_element(loop.torque_Nm.begin(), loop.torque_Nm.end());
  const double compliance = std::max(*high - *low, 1e-15) / std::max(*high_Nm - *low_Nm, 1e-15);
  const auto zero = MeanTwistAt(loop, 0.0);
  const auto half_width = [&](double level_Nm) {
    const auto up = MeanTwistAt(loop, level_Nm);
    const auto down = MeanTwistAt(loop, -level_Nm);
    if (up && down) {
      return 0.5 * (*up - *down);
    }
    if (zero && (up || down)) {
      return up ? *up - *zero : *zero - *down;
    }
    return compliance * level_Nm;
  };
  MidLine line;
  line.centre_rad = zero.value_or(0.5 * (*low + *high));
  line.knee1_rad = std::max(half_width(loop.torques.t1_Nm), 0.1 * compliance * loop.torques.t1_Nm);
  line.knee2_rad = std::max(half_width(loop.torques.t2_Nm),
                            line.knee1_rad + 0.1 * compliance * (loop.torques.t2_Nm - loop.torques.t1_Nm));
  return line;
}

struct GridPoint {
  StiffnessParameters start;
  double cost{};
};

// Columns: the twist's parts in the three segments, the element's state, a constant (for the offset of the
// twist).
constexpr int kColumns = 5;

void FillSpringColumns(const ThinnedLoop& loop, const MidLine& line, Eigen::MatrixXd* design) {
  for (Eigen::Index i = 0; i < design->rows(); ++i) {
    const double twist_rad = loop.twist_rad[static_cast<std::size_t>(i)] - line.centre_rad;
    const double sign = twist_rad < 0.0 ? -1.0 : 1.0;
    const double size = std::abs(twist_rad);
    (*design)(i, 0) = sign * std::min(size, line.knee1_rad);
    (*design)(i, 1) = sign * std::clamp(size - line.knee1_rad, 0.0, line.knee2_rad - line.knee1_rad);
    (*design)(i, 2) = sign * std::max(size - line.knee2_rad, 0.0);
    (*design)(i, 4) = 1.0;
  }
}

void FillFrictionColumn(const ThinnedLoop& loop, double yield_rad, double start_share,
                        Eigen::MatrixXd* design) {
  double share = start_share;
  for (Eigen::Index i = 0; i < design->rows(); ++i) {
    const auto sample = static_cast<std::size_t>(i);
    if (i > 0) {
      const double step_rad = loop.twist_input_rad[sample] - loop.twist_input_rad[sample - 1];
      share = std::clamp(share + step_rad / yield_rad, -1.0, 1.0);
    }
    (*design)(i, 3) = share;
  }
}

GridPoint FitGridPoint(const ThinnedLoop& loop, const TestTorques& torques, const MidLine& line,
                       double yield_rad, double start_share, const Eigen::MatrixXd& design) {
  const Eigen::Map<const Eigen::VectorXd> torque(loop.torque_Nm.data(), design.rows());
  const Eigen::VectorXd scale = design.colwise().norm().cwiseMax(1e-300).cwiseInverse();
  const Eigen::MatrixXd scaled = design * scale.asDiagonal();
  const Eigen::MatrixXd normal =
      scaled.transpose() * scaled + 1e-12 * Eigen::MatrixXd::Identity(kColumns, kColumns);
  const Eigen::VectorXd solution =
      scale.asDiagonal() * SymmetricFactor(normal).Solve(Eigen::VectorXd(scaled.transpose() * torque));
  GridPoint point;
  point.cost = (design * solution - torque).squaredNorm();
  // A slope that the thin linear fit leaves undetermined or negative starts from the secant through the
  // knees.
  const double secant1 = torques.t1_Nm / line.knee1_rad;
  const auto stiffness = [&](double fitted, double fallback) {
    return std::log(fitted > 0.2 * secant1 && fitted < 10.0 * secant1 ? fitted : fallback);
  };
  const double secant2 = (torques.t2_Nm - torques.t1_Nm) / (line.knee2_rad - line.knee1_rad);
  point.start[kLogK1] = stiffness(solution(0), secant1);
  point.start[kLogK2] = stiffness(solution(1), secant2);
  point.start[kLogK3] = stiffness(solution(2), secant2);
  point.start[kLogFriction] = std::log(std::max(solution(3), 1e-4 * torques.t1_Nm));
  point.start[kLogYieldTwist] = std::log(yield_rad);
  point.start[kStartShare] = start_share;
  point.start[kTwistOffset] = line.centre_rad - solution(4) / secant1;  // in rad until scaled
  if (solution(3) <= 0.0) {
    point.cost *= 2.0;  // friction that drives is none: keep such a start only for want of a better one
  }
  return point;
}

}  // namespace

LoopInputs MakeLoopInputs(const PreparedLoop& loop) {
  LoopInputs inputs;
  inputs.twist_branches = SplitBranches(loop.twist_rad, ReversalThreshold(loop.twist_noise_rad));
  inputs.torque_branches = SplitBranches(loop.torque_Nm, ReversalThreshold(loop.torque_noise_Nm));
  inputs.twist_rad = MonotoneWithinBranches(loop.twist_rad, inputs.twist_branches);
  inputs.torque_Nm = MonotoneWithinBranches(loop.torque_Nm, inputs.torque_branches);
  return inputs;
}

ThinnedLoop ThinLoop(const PreparedLoop& loop, const LoopInputs& inputs) {
  const std::size_t n = loop.torque_Nm.size();
  const std::size_t every = std::max<std::size_t>(1, n / kThinnedSamples);
  std::vector<bool> keep(n, false);
  for (std::size_t i = 0; i < n; i += every) {
    keep[i] = true;
  }
  for (const std::vector<Branch>* branches : {&inputs.twist_branches, &inputs.torque_branches}) {
    for (const Branch& branch : *branches) {
      keep[branch.first] = true;
      keep[branch.last] = true;
    }
  }
  ThinnedLoop thinned;
  for (std::size_t i = 0; i < n; ++i) {
    if (keep[i]) {
      thinned.torque_Nm.push_back(loop.torque_Nm[i]);
      thinned.twist_rad.push_back(loop.twist_rad[i]);
      thinned.twist_input_rad.push_back(inputs.twist_rad[i]);
      thinned.torque_input_Nm.push_back(inputs.torque_Nm[i]);
    }
  }
  return thinned;
}

std::vector<StiffnessParameters> StiffnessStarts(const PreparedLoop& loop, const ThinnedLoop& thinned,
                                                 double twist_scale_rad) {
  const MidLine line = FindMidLine(loop);
  Eigen::MatrixXd design(static_cast<Eigen::Index>(thinned.torque_Nm.size()), kColumns);
  FillSpringColumns(thinned, line, &design);
  std::vector<GridPoint> grid;
  for (int k = 0; k < kYieldTwists; ++k) {
    const double share = static_cast<double>(k) / (kYieldTwists - 1);
    const double yield_rad =
        twist_scale_rad * kSmallestYield * std::pow(kLargestYield / kSmallestYield, share);
    for (const double start_share : {0.0, 0.9, -0.9}) {
      FillFrictionColumn(thinned, yield_rad, start_share, &design);
      GridPoint point = FitGridPoint(thinned, loop.torques, line, yield_rad, start_share, design);
      point.start[kTwistOffset] /= twist_scale_rad;
      grid.push_back(point);
    }
  }
  std::stable_sort(grid.begin(), grid.end(),
                   [](const GridPoint& a, const GridPoint& b) { return a.cost < b.cost; });
  std::vector<StiffnessParameters> starts;
  for (const GridPoint& point : grid) {
    const bool distinct = std::all_of(starts.begin(), starts.end(), [&](const StiffnessParameters& other) {
      return std::abs(other[kLogYieldTwist] - point.start[kLogYieldTwist]) > std::log(2.0);
    });
    if (distinct) {
      starts.push_back(point.start);
    }
    if (starts.size() == kStarts) {
      break;
    }
  }
  return starts;
}

}  // namespace strainwave::analysis
