// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace strainwave::bench {

/// Asks for what a control loop on metal needs of the machine: the calling thread before all others
/// (SCHED_FIFO) and the program's memory kept in place.
/// @return nothing when both were granted; else what was refused, in words with what to do.
std::string BecomeRealtime();

}  // namespace strainwave::bench
