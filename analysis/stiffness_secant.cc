// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>

#include "analysis/prepared_loop.h"
#include "analysis/torsional_stiffness.h"

namespace strainwave::analysis {
namespace {

constexpr double kShareOfPeak = 0.98;

// A branch starts at zero torque when it passes it or begins next to it.
bool StartsAtZero(const PreparedLoop& loop, const Branch& branch) {
  const double start_Nm = loop.torque_Nm[branch.first];
  const double near_Nm = 0.1 * loop.torques.t1_Nm + 5.0 * loop.torque_noise_Nm.standard_deviation;
  return branch.rising ? start_Nm <= near_Nm : start_Nm >= -near_Nm;
}

std::optional<Branch> FirstLoading(const PreparedLoop& loop, bool rising) {
  for (const Branch& branch : loop.branches) {
    const double reached_Nm = loop.torque_Nm[branch.last] * (rising ? 1.0 : -1.0);
    if (branch.rising == rising && StartsAtZero(loop, branch) &&
        reached_Nm >= kShareOfPeak * loop.torques.t3_Nm) {
      return branch;
    }
  }
  return std::nullopt;
}

// A narrow line gives the value, so that a knee near by does not shift it. Its few samples cannot tell
// whether the noise is autocorrelated; a line eight times as wide can, and its error is scaled to the narrow
// one's share of samples.
Estimate TwistAt(const PreparedLoop& loop, const Branch& branch, double level_Nm) {
  constexpr double kWider = 8.0;
  const double window_Nm = 0.01 * loop.torques.t1_Nm;
  const double reach_Nm = loop.torques.t1_Nm;  // the caller has made sure that the branch goes there
  const auto narrow = TwistAtTorque(loop.torque_Nm, loop.twist_rad, branch, level_Nm, window_Nm, reach_Nm);
  const auto wide =
      TwistAtTorque(loop.torque_Nm, loop.twist_rad, branch, level_Nm, kWider * window_Nm, reach_Nm);
  if (!narrow || !wide) {
    return kNotEstimated;
  }
  return {narrow->value, std::max(narrow->standard_error, wide->standard_error * std::sqrt(kWider))};
}

Estimate Secant(double torque_step_Nm, const Estimate& from_rad, const Estimate& to_rad) {
  const double twist_step_rad = to_rad.value - from_rad.value;
  const double slope = torque_step_Nm / twist_step_rad;
  const double error_rad = std::hypot(from_rad.standard_error, to_rad.standard_error);
  return {slope, std::abs(slope * error_rad / twist_step_rad)};
}

}  // namespace

TorsionalStiffness FitStiffnessLoading(const TorsionLoop& raw, const TestTorques& torques) {
  const PreparedLoop loop = PrepareLoop(raw, torques);
  TorsionalStiffness result;
  std::optional<Branch> branch = FirstLoading(loop, true);
  if (!branch) {
    branch = FirstLoading(loop, false);
  }
  if (branch) {
    const double side = branch->rising ? 1.0 : -1.0;
    const double end_Nm = std::min(torques.t3_Nm, side * loop.torque_Nm[branch->last]);
    const Estimate at_zero = TwistAt(loop, *branch, 0.0);
    const Estimate at_t1 = TwistAt(loop, *branch, side * torques.t1_Nm);
    const Estimate at_t2 = TwistAt(loop, *branch, side * torques.t2_Nm);
    const Estimate at_end = TwistAt(loop, *branch, side * end_Nm);
    result.k1_Nm_per_rad = Secant(side * torques.t1_Nm, at_zero, at_t1);
    result.k2_Nm_per_rad = Secant(side * (torques.t2_Nm - torques.t1_Nm), at_t1, at_t2);
    result.k3_Nm_per_rad = Secant(side * (end_Nm - torques.t2_Nm), at_t2, at_end);
  } else {
    result.k1_Nm_per_rad = result.k2_Nm_per_rad = result.k3_Nm_per_rad = kNotEstimated;
    result.failed_checks.push_back("no loading branch from zero torque to T3");
  }
  MeasureLoopWidth(loop, &result);
  CheckLoop(loop, &result);
  return result;
}

}  // namespace strainwave::analysis
