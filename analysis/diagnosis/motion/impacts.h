// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "analysis/diagnosis/motion/samples.h"

namespace strainwave::analysis::diagnosis {

/// A load that strikes where a gap closes may do so within one sample of the torque, which looks like a spike
/// of the measurement. It is none where one inertia behind backlash predicts several of them, their times,
/// signs and heights together, and does not predict others that are not there.
/// @param samples  of the records, with all spikes bridged
/// @returns the same, or with those left in that an inertia behind backlash explains
MotionSamples KeepImpacts(std::span<const MotionData> records, MotionSamples samples);

}  // namespace strainwave::analysis::diagnosis
