// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

namespace strainwave::analysis::diagnosis {

struct MotionGrid;

/// What a detail of the nominal model has to bring, in −2 log-likelihood.
inline constexpr double kClearDetail = 12.0;

/// A part of the friction that bends before it slides; b its bend, −1 to 1, along the position q.
struct PreslidingElement {
  double way{};    // rad or m
  double share{};  // of the Coulomb friction
  bool gradual{};  // db/dq = (1 − b sgn q̇)/way (docs/sources.md#dahl-1968); else 1/way up to the end
};

/// How Coulomb friction changes its sign at a reversal.
struct ReversalSmoothing {
  double width{};     // speed over which it changes; 0: at once
  bool hyperbolic{};  // as a tanh, which takes longer to get to the end than an error function
  /// Where there are any, it changes over a way instead, and keeps its value at rest: elements in parallel
  /// (docs/sources.md#iwan-1966), which make up presliding hysteresis that does not depend on speed, whatever
  /// its law. Their shares sum to 1.
  std::vector<PreslidingElement> elements{};

  /// −1 to 1, by velocity alone.
  std::vector<double> SignsOf(std::span<const double> velocities) const;
};

/// Of its elements, each by its share; 0 where there are none.
double MeanWay(const ReversalSmoothing& reversal_smoothing);

/// Chooses the grid's reversal smoothing, its direction and the column of its Coulomb friction: the sign may
/// change over a small speed, or over a short way, instead of at once; a detail, as long as it is small.
/// @param torque  of the rows
/// @param delay_s  by which the torque acts late: a lag passes for a wide reversal smoothing, so the motion
/// at that time
///   counts
/// @returns the reversal smoothings that the rows leave open, the chosen one among them; empty where an axis
///   never turns.
std::vector<ReversalSmoothing> ChooseReversalSmoothing(MotionGrid& grid, const Eigen::VectorXd& torque,
                                                       double delay_s);

/// Share of the Coulomb friction that acts at each point of the grid, −1 to 1, by a reversal smoothing; a
/// time later.
std::vector<double> DirectionBy(const ReversalSmoothing& reversal_smoothing, const MotionGrid& grid,
                                double shift_s);

/// The same by the grid's own.
std::vector<double> DirectionLater(const MotionGrid& grid, double shift_s);

}  // namespace strainwave::analysis::diagnosis
