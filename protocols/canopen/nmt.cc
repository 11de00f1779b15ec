// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/nmt.h"

#include "protocols/canopen/wire_bytes.h"

namespace strainwave::protocols::canopen {

std::string_view Name(NmtState state) {
  switch (state) {
    case NmtState::kBootUp:
      return "boot-up";
    case NmtState::kStopped:
      return "stopped";
    case NmtState::kOperational:
      return "operational";
    case NmtState::kPreOperational:
      return "pre-operational";
  }
  return "not an NMT state";
}

CanFrame NmtFrame(NmtCommand command, std::uint8_t node_id) noexcept {
  return FrameOf(0x000, {static_cast<std::uint8_t>(command), node_id});
}

std::optional<NmtState> NmtStateOf(std::uint8_t heartbeat_byte) noexcept {
  const auto state = static_cast<NmtState>(heartbeat_byte & 0x7F);
  switch (state) {
    case NmtState::kBootUp:
    case NmtState::kStopped:
    case NmtState::kOperational:
    case NmtState::kPreOperational:
      return state;
  }
  return std::nullopt;
}

}  // namespace strainwave::protocols::canopen
