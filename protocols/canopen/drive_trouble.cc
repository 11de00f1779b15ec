// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/drive_trouble.h"

namespace strainwave::protocols::canopen {

std::string_view Words(DriveTrouble trouble) {
  switch (trouble) {
    case DriveTrouble::kNone:
      return "no trouble";
    case DriveTrouble::kQuickStopAsked:
      return "quick stop was asked for";
    case DriveTrouble::kCommissioningFailed:
      return "the drive could not be set up";
    case DriveTrouble::kNotOperational:
      return "the drive was set up, but did not start to exchange process data";
    case DriveTrouble::kHeartbeatLost:
      return "the drive's heartbeat is lost: no power, cable, or the drive hangs";
    case DriveTrouble::kNodeRebooted:
      return "the drive started anew while in use: a dip of its supply or a reset; its settings are gone";
    case DriveTrouble::kNmtStateChanged:
      return "the drive left the operational state by itself: it may miss the master's heartbeat";
    case DriveTrouble::kEmergency:
      return "the drive sent an emergency message";
    case DriveTrouble::kFault:
      return "the drive is in fault";
    case DriveTrouble::kFaultNotReset:
      return "the drive stays in fault after a reset: the cause is still there";
    case DriveTrouble::kSafeTorqueOff:
      return "safe torque off is open: an emergency stop, a guard, or its wiring";
    case DriveTrouble::kStoppedByDrive:
      return "the drive stopped by itself: safe torque off, limit switch or enable input";
    case DriveTrouble::kStatusUnclear:
      return "the statusword fits no state of the standard";
    case DriveTrouble::kModeNotConfirmed:
      return "the drive does not confirm the mode of operation";
    case DriveTrouble::kEnableTimedOut:
      return "the drive does not reach operation enabled";
    case DriveTrouble::kFollowingError:
      return "the shaft does not follow its set-point";
    case DriveTrouble::kHomingFailed:
      return "homing failed";
    case DriveTrouble::kStaysEnabled:
      return "the drive stays enabled although it was told to stop";
    case DriveTrouble::kBusOff:
      return "CAN bus-off: short circuit, wrong bit rate or termination";
    case DriveTrouble::kTransmitQueueFull:
      return "the CAN transmit queue is full: nobody acknowledges, or the bus is overloaded";
    case DriveTrouble::kPdoMissing:
      return "the drive's process data no longer come in";
    case DriveTrouble::kSyncJitter:
      return "SYNC came too early or too late: the control computer is overloaded";
  }
  return "not a trouble";
}

bool NeedsCommissioning(DriveTrouble trouble) {
  switch (trouble) {
    case DriveTrouble::kCommissioningFailed:
    case DriveTrouble::kNotOperational:
    case DriveTrouble::kHeartbeatLost:
    case DriveTrouble::kNodeRebooted:
    case DriveTrouble::kNmtStateChanged:
    case DriveTrouble::kBusOff:
      return true;
    case DriveTrouble::kNone:
    case DriveTrouble::kQuickStopAsked:
    case DriveTrouble::kEmergency:
    case DriveTrouble::kFault:
    case DriveTrouble::kFaultNotReset:
    case DriveTrouble::kSafeTorqueOff:
    case DriveTrouble::kStoppedByDrive:
    case DriveTrouble::kStatusUnclear:
    case DriveTrouble::kModeNotConfirmed:
    case DriveTrouble::kEnableTimedOut:
    case DriveTrouble::kFollowingError:
    case DriveTrouble::kHomingFailed:
    case DriveTrouble::kStaysEnabled:
    case DriveTrouble::kTransmitQueueFull:
    case DriveTrouble::kPdoMissing:
    case DriveTrouble::kSyncJitter:
      return false;
  }
  return true;
}

}  // namespace strainwave::protocols::canopen
