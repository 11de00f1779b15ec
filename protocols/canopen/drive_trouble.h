// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace strainwave::protocols::canopen {

/// Why a drive was stopped, or does not start. Each is told apart from the others on a technician's screen.
enum class DriveTrouble : std::uint8_t {
  kNone,
  kQuickStopAsked,
  kCommissioningFailed,
  kNotOperational,
  kHeartbeatLost,
  kNodeRebooted,
  kNmtStateChanged,
  kEmergency,
  kFault,
  kFaultNotReset,
  kSafeTorqueOff,
  kStoppedByDrive,
  kStatusUnclear,
  kModeNotConfirmed,
  kEnableTimedOut,
  kFollowingError,
  kHomingFailed,
  kStaysEnabled,
  kBusOff,
  kTransmitQueueFull,
  kPdoMissing,
  kSyncJitter,
};
inline constexpr int kDriveTroubles = 22;

std::string_view Words(DriveTrouble trouble);

/// After these the drive's settings are not known any more: it has to be commissioned anew.
bool NeedsCommissioning(DriveTrouble trouble);

}  // namespace strainwave::protocols::canopen
