// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

namespace strainwave::analysis::diagnosis {

struct MotionGrid;

/// How the sign of a velocity changes on the way from one direction to the other.
struct ReversalSmoothing {
  double width{};     // speed over which it changes; 0: at once
  bool hyperbolic{};  // as a tanh, which takes longer to get to the end than an error function

  /// −1 to 1.
  std::vector<double> SignsOf(std::span<const double> velocities) const;
};

/// Chooses the grid's reversal smoothing, its direction and the column of its Coulomb friction: the sign may
/// change over a small speed instead of at once, a detail, as long as it is small.
/// @param torque  of the rows
/// @param delay_s  by which the torque acts late: a lag passes for a wide reversal smoothing, so the motion
/// at that time
///   counts
/// @returns the reversal smoothings that the rows leave open, the chosen one among them; empty where an axis
///   never turns.
std::vector<ReversalSmoothing> ChooseReversalSmoothing(MotionGrid& grid, const Eigen::VectorXd& torque,
                                                       double delay_s);

}  // namespace strainwave::analysis::diagnosis
