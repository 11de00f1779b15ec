// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace strainwave::bench {

/// Who goes before whom, as priorities of SCHED_FIFO: above every ordinary thread, below the kernel's own
/// interrupt threads.
enum class RealtimeRank : int { kDeviceSide = 20, kAcquisition = 30, kControl = 40, kBus = 45 };

/// Asks for what a cyclic thread of a real bench needs of the machine: the calling thread before ordinary
/// ones, and the program's memory kept in place.
/// @return nothing when both were granted; else what was refused, in words with what to do.
std::string BecomeRealtime(RealtimeRank rank);

}  // namespace strainwave::bench
