// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bench/devices/canopen/drive_bus.h"

namespace strainwave::bench {

/// What has gone wrong on a bus, in a technician's words, one entry a thing: the worst state that its
/// controller has been in, and frames that are not as they must be.
/// @param told  what was known before; default: nothing. A thing that showed in it is left out.
std::vector<std::string> BusTroubles(const DriveBusCounts& counts, const DriveBusCounts& told = {});

}  // namespace strainwave::bench
