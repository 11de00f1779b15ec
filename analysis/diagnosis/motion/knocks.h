// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "analysis/diagnosis/motion/samples.h"

namespace strainwave::analysis::diagnosis {

/// A load that knocks where a gap closes may do so within one sample of the torque, which looks like a spike
/// of the measurement. It is none where one loose load foretells several of them, their times, signs and
/// heights together, and does not foretell others that are not there.
/// @param samples  of the records, with all spikes bridged
/// @returns the same, or with those left in that a loose load explains
MotionSamples KeepKnocks(std::span<const MotionData> records, MotionSamples samples);

}  // namespace strainwave::analysis::diagnosis
