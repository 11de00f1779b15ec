// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analysis/diagnosis/records.h"

namespace strainwave::analysis::diagnosis {

/// Bridges samples of the torque that stand off their neighbours, before a low-pass spreads them. They are
/// looked for in the torque as it is and, where the axis accelerates so fast that the torque changes by more
/// than they are high, in what the motion leaves of it.
/// @param resolution  step of a quantised torque; 0 for a continuous one
/// @param kept  samples that are known not to be spikes, ascending
/// @returns which, ascending
std::vector<std::size_t> BridgeSpikes(MotionData& record, double resolution,
                                      std::span<const std::size_t> kept);

}  // namespace strainwave::analysis::diagnosis
