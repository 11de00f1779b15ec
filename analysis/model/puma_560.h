// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "analysis/model/joint_losses.h"
#include "analysis/model/rigid_arm.h"

/// The Unimation PUMA 560, an arm of six joints whose inertias, friction and limits have been measured and
/// published. It carries 2.5 kg; what is scaled to an arm of another size says so.
namespace strainwave::analysis::model {

/// Source: docs/sources.md#corke-1994 (standard frames), after docs/sources.md#armstrong-1986.
std::vector<ArmLink> Puma560();

/// At the joint: Coulomb and viscous levels of the motors times the ratio and its square, the same source,
/// mean of both directions. Breakaway and Stribeck speed are not published; they are 1.3 times Coulomb and
/// 0.05 rad/s.
std::vector<JointFriction> Puma560Friction();

/// What each joint's motor can give. Source: docs/sources.md#armstrong-1986.
std::vector<double> Puma560PeakTorques_Nm();

}  // namespace strainwave::analysis::model
