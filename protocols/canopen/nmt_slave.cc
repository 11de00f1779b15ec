// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/nmt_slave.h"

#include "protocols/canopen/device_frames.h"

namespace strainwave::protocols::canopen::device {

std::optional<NodeCommand> CommandTo(std::uint8_t node_id, const CanFrame& frame) {
  if (!IsPlainData(frame) || frame.id != 0 || frame.length != 2) return std::nullopt;
  if (frame.data[1] != 0 && frame.data[1] != node_id) return std::nullopt;
  const auto command = static_cast<NodeCommand>(frame.data[0]);
  switch (command) {
    case NodeCommand::kStart:
    case NodeCommand::kStop:
    case NodeCommand::kEnterPreOperational:
    case NodeCommand::kResetNode:
    case NodeCommand::kResetCommunication:
      return command;
  }
  return std::nullopt;
}

NodeState NextNodeState(NodeState state, NodeCommand command) {
  if (state == NodeState::kInitialising) return state;
  switch (command) {
    case NodeCommand::kStart:
      return NodeState::kOperational;
    case NodeCommand::kStop:
      return NodeState::kStopped;
    case NodeCommand::kEnterPreOperational:
      return NodeState::kPreOperational;
    case NodeCommand::kResetNode:
    case NodeCommand::kResetCommunication:
      return NodeState::kInitialising;
  }
  return state;
}

}  // namespace strainwave::protocols::canopen::device
