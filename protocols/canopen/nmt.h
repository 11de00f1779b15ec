// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "protocols/can_frame.h"

namespace strainwave::protocols::canopen {

/// Network management commands (CiA 301, 7.2.8.3.1).
enum class NmtCommand : std::uint8_t {
  kStart = 0x01,
  kStop = 0x02,
  kEnterPreOperational = 0x80,
  kResetNode = 0x81,
  kResetCommunication = 0x82,
};

/// States as heartbeats report them (CiA 301, 7.2.8.3.2).
enum class NmtState : std::uint8_t {
  kBootUp = 0x00,
  kStopped = 0x04,
  kOperational = 0x05,
  kPreOperational = 0x7F,
};

std::string_view Name(NmtState state);

/// To one node, or to all by node_id 0.
CanFrame NmtFrame(NmtCommand command, std::uint8_t node_id) noexcept;

/// The state in a heartbeat's byte. Bit 7 is the toggle bit of node guarding and says nothing; nothing for a
/// number that is no state.
std::optional<NmtState> NmtStateOf(std::uint8_t heartbeat_byte) noexcept;

}  // namespace strainwave::protocols::canopen
