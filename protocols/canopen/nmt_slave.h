// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "protocols/can_frame.h"

namespace strainwave::protocols::canopen::device {

/// States of a node (CiA 301, 7.3.2.2), by the numbers that its heartbeat has for them.
enum class NodeState : std::uint8_t {
  kInitialising = 0x00,
  kStopped = 0x04,
  kOperational = 0x05,
  kPreOperational = 0x7F,
};

/// What the master of the network asks of nodes, by the numbers of the frame.
enum class NodeCommand : std::uint8_t {
  kStart = 0x01,
  kStop = 0x02,
  kEnterPreOperational = 0x80,
  kResetNode = 0x81,
  kResetCommunication = 0x82,
};

/// The command of an NMT frame (id 0, two bytes) to this node or to all; nothing for anything else.
std::optional<NodeCommand> CommandTo(std::uint8_t node_id, const CanFrame& frame);

/// The state after it. A reset leads to initialising, which a node leaves by itself with its boot-up message.
NodeState NextNodeState(NodeState state, NodeCommand command);

}  // namespace strainwave::protocols::canopen::device
