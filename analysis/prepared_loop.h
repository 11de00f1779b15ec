// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "analysis/loop_branches.h"
#include "analysis/noise_level.h"
#include "analysis/torsional_stiffness.h"

namespace strainwave::analysis {

/// A torsion loop made ready for the three methods: arguments checked, single spikes bridged, the twist
/// turned to rise with the torque, the record cut at its reversals.
struct PreparedLoop {
  TestTorques torques;
  std::vector<double> torque_Nm;
  std::vector<double> twist_rad;
  std::vector<std::size_t> spikes;  // samples that were bridged, ascending
  NoiseLevel torque_noise_Nm;
  NoiseLevel twist_noise_rad;
  std::vector<Branch> branches;  // of the torque; wiggles below 2 % of T₃ are none
  bool sign_swapped{};           // the twist was turned: it falls with torque

  double RatedTorque_Nm() const { return torques.rated_Nm > 0.0 ? torques.rated_Nm : torques.t3_Nm; }
  /// Half the distance over which the curve about zero torque is taken as straight.
  double ZeroWindow_Nm() const { return 0.25 * torques.t1_Nm; }
};

/// @throws std::invalid_argument as documented at FitStiffnessModel.
PreparedLoop PrepareLoop(const TorsionLoop& loop, const TestTorques& torques);

/// Width of the loop at zero torque and lost motion, from straight lines through the branches near zero
/// torque. A branch counts when it comes from a reversal beyond T₁ (elsewhere the friction has not settled);
/// where a direction has none such, the others stand in. NaN where the record has no loading or no unloading
/// branch at zero torque.
void MeasureLoopWidth(const PreparedLoop& loop, TorsionalStiffness* result);

/// Appends the checks that every method shares: torque reached on both sides, samples in each segment, loop
/// closed, sign of the twist, stiffness positive. Call it last.
void CheckLoop(const PreparedLoop& loop, TorsionalStiffness* result);

/// Turns the slopes of a loop whose twist was turned, so that they say what the record says.
void RestoreSign(const PreparedLoop& loop, TorsionalStiffness* result);

}  // namespace strainwave::analysis
