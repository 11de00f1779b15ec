// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace strainwave::daq::acquisition {

/// Of the monotonic clock, which the arrival of a block is stamped with.
inline std::chrono::nanoseconds SteadyNow() { return std::chrono::steady_clock::now().time_since_epoch(); }

}  // namespace strainwave::daq::acquisition
