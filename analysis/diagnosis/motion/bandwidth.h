// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "analysis/diagnosis/motion/samples.h"

namespace strainwave::analysis::diagnosis {

/// What the record's own noise says about how far it should be smoothed.
struct MotionBandwidth {
  double sigma_s{};         // of the low-pass of torque and terms
  double path_sigma_s{};    // of velocity and acceleration: the same, or wider where the path is smooth
  double fine_sigma_s{};    // of position and velocity where terms are evaluated
  bool by_velocity{};       // derivatives from the velocity column, which is the quieter one
  double velocity_noise{};  // of the fine velocity
  double inertia{};         // about
  double coulomb{};         // about
};

/// Velocity and acceleration are smoothed until the noise of inertia · acceleration does not show beside that
/// of the torque, not even over the whole record: what shows of it shrinks the inertia, and lends itself to
/// any term that smooths the acceleration, a resonance above all. But most of the acceleration there is is
/// kept.
///
/// The torque and all terms pass the same low-pass, so that nothing of the motion's edges is lost on one side
/// only. Where the path has no edges (a stiff loop on a smooth reference: wider and narrower smoothing give
/// the same acceleration throughout) the torque keeps its full bandwidth, or what fits into `most_rows`. The
/// fine smoothing blurs a reversal by about as much as velocity noise moves it.
MotionBandwidth ChooseBandwidth(const MotionSamples& samples, std::size_t most_rows);

}  // namespace strainwave::analysis::diagnosis
