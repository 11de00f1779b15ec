// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "bench/devices/can/socket_can_bus.h"
#include "protocols/canopen/drive_profile.h"

namespace strainwave::bench {

/// What the kernel lets through to the master of a drive: what concerns its node, and those of its PDOs whose
/// COB-IDs do not bear its number.
std::vector<CanFilter> FiltersOfDrive(const protocols::canopen::DriveProfile& profile, std::uint8_t node_id);

}  // namespace strainwave::bench
