// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "analysis/diagnosis/motion/samples.h"

namespace strainwave::analysis::diagnosis {

/// How far the record is smoothed.
struct MotionBandwidth {
  double sigma_s{};       // of the low-pass of torque and terms: as little as `most_rows` lets
  bool passes_all{};      // no low-pass: torque and terms sample by sample
  double path_sigma_s{};  // of position, velocity and acceleration
  double calm_sigma_s{};  // of an acceleration whose noise is nothing beside the torque's over the record
  bool by_velocity{};     // derivatives from the velocity column, which shows more of the motion
  double velocity_noise{};
  double inertia{};  // about
  double coulomb{};  // about
};

/// Whether the low-pass is the narrowest there is for samples at a step: no row is made of more of them than
/// it has to be.
bool KeepsUpWith(const MotionBandwidth& bandwidth, double step_s);

/// Noise of the acceleration is an error of a regressor: it shrinks the inertia, and lends itself to any term
/// that smooths the acceleration, a resonance above all. So the motion is smoothed, half an octave at a time
/// from the top, until what is left of the noise does not show beside that of the torque, not even over the
/// whole record; but only as long as nothing is lost that matters to the torque: too little to show, or no
/// motion but noise. Most of the acceleration is kept at any rate.
MotionBandwidth ChooseBandwidth(const MotionSamples& samples, std::size_t most_rows);

}  // namespace strainwave::analysis::diagnosis
