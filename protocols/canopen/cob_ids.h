// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace strainwave::protocols::canopen {

/// COB-ID of a heartbeat, less the node's id (CiA 301, predefined connection set).
inline constexpr std::uint32_t kHeartbeatBase = 0x700;

}  // namespace strainwave::protocols::canopen
