// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "analysis/diagnosis/motion/bandwidth.h"
#include "analysis/diagnosis/motion/delay.h"
#include "analysis/diagnosis/motion/samples.h"
#include "analysis/diagnosis/motion/terms.h"

namespace strainwave::analysis::diagnosis {

/// A grid whose rows are the samples themselves; no delay is expected.
/// @throws std::invalid_argument where too little motion is left.
SharedGrid WithoutLowPass(const MotionSamples& samples, MotionBandwidth bandwidth);

struct SettledGrid {
  SharedGrid grid;
  DelayEstimate delay;  // as it shows where torque and terms are low-passed
};

/// The grid, made again where the torque acts late: reversals show in it before they show in the motion.
/// Whether they are blurred by the lag or by a wide reversal smoothing from one way to the other, what is
/// left tells.
///
/// Made again without the low-pass where what is missing is faint: the impacts of a small gap last a sample
/// or two, of which the low-pass keeps a part. A delay has to show first, since torque that is a step from
/// one sample to the next cannot be moved by less.
///
/// @throws std::invalid_argument where too little motion is left.
SettledGrid MakeSettledGrid(const MotionSamples& samples);

}  // namespace strainwave::analysis::diagnosis
