// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/diagnosis/motion/samples.h"

namespace strainwave::analysis::diagnosis {

/// Cuts a record at its gaps and brings what lies between onto even steps.
///
/// Doubled rows are dropped. Equal stamps on different rows are of a clock that ticks more slowly than
/// samples are taken, if they stay within a tick of even ones; else they are spread up to the next one.
/// Stamps that jitter while the motion goes on evenly (the position is smoother over the row's number than
/// over its stamp) are replaced by a straight line; else the columns are interpolated. Gaps of up to three
/// steps are bridged.
///
/// @param name      of the record in `warnings`, "" or "record 2: "
/// @param clipped   one a row
std::vector<EvenSegment> EvenSegments(const MotionData& record, const std::vector<bool>& clipped,
                                      const std::string& name, std::vector<std::string>& warnings);

}  // namespace strainwave::analysis::diagnosis
