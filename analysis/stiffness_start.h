// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "analysis/prepared_loop.h"
#include "analysis/stiffness_curve.h"

namespace strainwave::analysis {

/// The two signals of a loop made monotone between their reversals, and where these are.
struct LoopInputs {
  std::vector<double> twist_rad;
  std::vector<double> torque_Nm;
  std::vector<Branch> twist_branches;
  std::vector<Branch> torque_branches;
};

LoopInputs MakeLoopInputs(const PreparedLoop& loop);

/// Every n-th sample of a loop together with all reversals. Between reversals the friction element depends on
/// where the signal has come to and not on the steps it took, so that the model on these samples is the model
/// on all.
struct ThinnedLoop {
  std::vector<double> torque_Nm;
  std::vector<double> twist_rad;
  std::vector<double> twist_input_rad;
  std::vector<double> torque_input_Nm;
};

ThinnedLoop ThinLoop(const PreparedLoop& loop, const LoopInputs& inputs);

/// Starting values for the loop model, best first: secants of the mid-line give the breaks; with these held,
/// the model is linear in everything but the yield twist and the element's first state, which are searched on
/// a grid. The starts returned differ in yield twist by more than a factor of two.
std::vector<StiffnessParameters> StiffnessStarts(const PreparedLoop& loop, const ThinnedLoop& thinned,
                                                 double twist_scale_rad);

}  // namespace strainwave::analysis
