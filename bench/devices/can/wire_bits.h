// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocols/can_frame.h"

namespace strainwave::bench {

/// Bits that a classical frame takes on the wire, the stuffed ones and the three between frames among them
/// (ISO 11898-1, 10.4 and 10.5). An error frame: 23, six flags of either node, delimiter and the pause.
int WireBits(const protocols::CanFrame& frame) noexcept;

}  // namespace strainwave::bench
