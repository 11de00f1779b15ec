// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "protocols/canopen/drive_master.h"

namespace strainwave::protocols::canopen {

std::string_view Name(DriveStage stage) {
  switch (stage) {
    case DriveStage::kOff:
      return "not set up";
    case DriveStage::kCommissioning:
      return "being set up";
    case DriveStage::kStarting:
      return "starting";
    case DriveStage::kDisabled:
      return "disabled";
    case DriveStage::kChangingMode:
      return "changing its mode";
    case DriveStage::kRaising:
      return "being enabled";
    case DriveStage::kEnabled:
      return "enabled";
    case DriveStage::kStopping:
      return "stopping";
    case DriveStage::kStopped:
      return "stopped";
    case DriveStage::kResetting:
      return "being reset";
    case DriveStage::kSilent:
      return "left alone";
  }
  return "not a stage";
}

std::string_view Words(DriveAnswer answer) {
  switch (answer) {
    case DriveAnswer::kAccepted:
      return "accepted";
    case DriveAnswer::kCommissionFirst:
      return "the drive has to be set up first";
    case DriveAnswer::kResetFirst:
      return "the drive was stopped and has to be reset first";
    case DriveAnswer::kStillStopping:
      return "the drive is still stopping";
    case DriveAnswer::kDisableFirst:
      return "the drive has to be disabled first";
    case DriveAnswer::kDriveInFault:
      return "the drive is in fault";
    case DriveAnswer::kModeNotInProfile:
      return "the mode is not in the drive's profile";
    case DriveAnswer::kStatusStale:
      return "the drive's process data are stale";
    case DriveAnswer::kNotEnabledInMode:
      return "the drive is not enabled in a mode that takes this set-point";
    case DriveAnswer::kNotANumber:
      return "the set-point is not a number that the drive can count";
  }
  return "not an answer";
}

std::string DriveMaster::TroubleWords() const {
  const std::string words = fmt::format("node {}: {}", node_id_, Words(trouble_));
  // Some details name the node themselves.
  const auto said = [&](const std::string& detail) { return fmt::format("{}: {}", Words(trouble_), detail); };
  switch (trouble_) {
    case DriveTrouble::kCommissioningFailed:
      return said(commissioning_.FailureWords());
    case DriveTrouble::kEmergency:
      return trip_.emergency ? said(Words(*trip_.emergency)) : words;
    case DriveTrouble::kFault:
    case DriveTrouble::kFaultNotReset: {
      if (trip_.error_code != 0) {
        return fmt::format("{}: {:04X}h, {}", words, trip_.error_code, ErrorCodeWords(trip_.error_code));
      }
      return trip_.emergency ? said(Words(*trip_.emergency)) : words;
    }
    case DriveTrouble::kNmtStateChanged:
      return trip_.nmt_state ? fmt::format("{} ({})", words, Name(*trip_.nmt_state)) : words;
    case DriveTrouble::kStoppedByDrive:
    case DriveTrouble::kEnableTimedOut:
      return trip_.power ? fmt::format("{} ({})", words, Name(*trip_.power)) : words;
    case DriveTrouble::kModeNotConfirmed:
      return fmt::format("{}: {} was asked for, 6061h shows {}", words, Name(mode_), trip_.mode_display);
    case DriveTrouble::kPdoMissing:
      return fmt::format("{} (PDO {:X}h)", words, trip_.missing_cob_id);
    case DriveTrouble::kSyncJitter:
      return fmt::format("{} (after {} µs instead of {} µs)", words, trip_.sync_interval.count() / 1000,
                         profile_.timing.sync_period.count() / 1000);
    case DriveTrouble::kNone:
    case DriveTrouble::kQuickStopAsked:
    case DriveTrouble::kNotOperational:
    case DriveTrouble::kHeartbeatLost:
    case DriveTrouble::kNodeRebooted:
    case DriveTrouble::kSafeTorqueOff:
    case DriveTrouble::kStatusUnclear:
    case DriveTrouble::kFollowingError:
    case DriveTrouble::kHomingFailed:
    case DriveTrouble::kStaysEnabled:
    case DriveTrouble::kBusOff:
    case DriveTrouble::kTransmitQueueFull:
      return words;
  }
  return words;
}

}  // namespace strainwave::protocols::canopen
