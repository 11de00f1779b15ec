// SPDX-License-Identifier: Apache-2.0
// What comes in from the drive, and what it means for where the master stands.
#include <algorithm>

#include "protocols/canopen/drive_master.h"
#include "protocols/canopen/wire_bytes.h"

namespace strainwave::protocols::canopen {
namespace {

using std::chrono::nanoseconds;

constexpr std::uint32_t kBusOffClass = 0x40;  // of an error frame, as Linux reports it

bool Maps(const PdoSetting& pdo, ObjectAddress address) {
  return std::any_of(pdo.entries.begin(), pdo.entries.end(),
                     [&](const PdoEntry& entry) { return entry.address == address; });
}

}  // namespace

void DriveMaster::OnFrame(const CanFrame& frame, nanoseconds now) noexcept {
  if (frame.error) {
    if ((frame.id & kBusOffClass) != 0) OnBusOff(now);
    return;
  }
  if (stage_ == DriveStage::kCommissioning) commissioning_.OnFrame(frame, now);
  if (const auto event = heartbeats_.OnFrame(frame, now)) OnHeartbeatEvent(*event, now);
  if (const auto emergency = EmergencyOf(frame); emergency && emergency->node_id == node_id_) {
    OnEmergency(*emergency, now);
  }
  OnPdo(frame, now);
}

void DriveMaster::OnHeartbeatEvent(HeartbeatEvent event, nanoseconds now) noexcept {
  switch (event) {
    case HeartbeatEvent::kBootUp:
      // Before commissioning a boot-up is what one waits for.
      if (stage_ != DriveStage::kOff) Trip(DriveTrouble::kNodeRebooted, now);
      break;
    case HeartbeatEvent::kStateChanged:
    case HeartbeatEvent::kReturned:
      if (IsExchanging() && heartbeats_.state() != NmtState::kOperational) {
        Trip(DriveTrouble::kNmtStateChanged, now);
      }
      break;
    case HeartbeatEvent::kLost:
      Trip(DriveTrouble::kHeartbeatLost, now);
      break;
  }
}

void DriveMaster::OnEmergency(const Emergency& emergency, nanoseconds now) noexcept {
  emergency_ = emergency;
  const std::vector<std::uint16_t>& warnings = profile_.quirks.warning_codes;
  const bool is_warning = std::find(warnings.begin(), warnings.end(), emergency.code) != warnings.end();
  // While the drive is being set up its old errors may be told; those that last show in the statusword.
  if (IsExchanging() && !emergency.is_reset() && !is_warning) Trip(DriveTrouble::kEmergency, now);
}

// A drive that started anew in the midst of work sends process data again: somebody else has set it going,
// and may raise it next. Only its own master may, and that will set it up first.
void DriveMaster::KeepFromOperation() noexcept {
  if (trouble_ == DriveTrouble::kNone || trouble_ == DriveTrouble::kBusOff) return;
  (void)out_.PushNewest(NmtFrame(NmtCommand::kEnterPreOperational, node_id_));
}

void DriveMaster::OnPdo(const CanFrame& frame, nanoseconds now) noexcept {
  for (std::size_t i = 0; i < pdos_.size(); ++i) {
    const PdoSetting& pdo = pdos_[i];
    if (pdo.flow != PdoFlow::kFromDrive || !IsDataFrame(frame, pdo.cob_id)) continue;
    if (stage_ == DriveStage::kOff) KeepFromOperation();
    // Before the drive has been set up, it may have mapped anything.
    if (stage_ == DriveStage::kOff || stage_ == DriveStage::kCommissioning) return;
    if (!DecodeFromDrive(pdo, frame, inputs_)) {
      ++malformed_frames_;
      return;
    }
    received_[i] = {.syncs_ago = 0, .has_come = true};
    if (Maps(pdo, kPositionActualObject)) {
      // What a drive sends with SYNC it has sampled at SYNC.
      status_.time = pdo.transmission_type <= 240 ? last_sync_ : now;
    }
    UpdateFreshness();
    UpdateStatus();
    if (Maps(pdo, kStatuswordObject)) OnStatus(now);
    return;
  }
}

void DriveMaster::UpdateFreshness() noexcept {
  status_.is_stale = false;
  for (std::size_t i = 0; i < pdos_.size(); ++i) {
    if (pdos_[i].flow != PdoFlow::kFromDrive) continue;
    const bool is_fresh =
        received_[i].has_come && received_[i].syncs_ago <= profile_.timing.stale_after_syncs;
    if (!is_fresh) {
      status_.is_stale = true;
      if (trouble_ == DriveTrouble::kNone) trip_.missing_cob_id = pdos_[i].cob_id;
    }
  }
}

bool DriveMaster::Read(const BitSource& source) const noexcept {
  const std::uint32_t word =
      source.from == BitSource::From::kStatusword ? inputs_.statusword : inputs_.digital_inputs;
  return ((word & source.mask) != 0) != source.is_low_active;
}

void DriveMaster::UpdateStatus() noexcept {
  status_.position_rad = PositionRad(profile_.units, inputs_.position);
  status_.speed_rad_per_s = SpeedRadPerS(profile_.units, inputs_.velocity);
  status_.torque_Nm = TorqueNm(profile_.units, inputs_.torque);
  status_.power = PowerStateOf(inputs_.statusword);
  status_.mode = OperationModeOf(inputs_.mode_display);
  status_.bits = StatusBitsOf(status_.mode.value_or(OperationMode::kNone), inputs_.statusword);
  status_.error_code = inputs_.error_code;
  if (profile_.brake.engaged_feedback.from != BitSource::From::kNowhere) {
    status_.is_brake_engaged = Read(profile_.brake.engaged_feedback);
  }
  if (profile_.safe_torque_off.from != BitSource::From::kNowhere) {
    status_.is_torque_safely_off = Read(profile_.safe_torque_off);
  }
}

void DriveMaster::OnStatus(nanoseconds now) noexcept {
  if (!IsExchanging()) return;
  const bool torque_is_safely_off = !status_.is_stale && status_.is_torque_safely_off.value_or(false);
  if (stage_ == DriveStage::kStopped) {
    // Of a drive that stopped for it, and said so in its own way, it is the reason. After a stop that was
    // asked for, it may be open: a person is at the shafts.
    const bool by_itself = trouble_ != DriveTrouble::kNone && trouble_ != DriveTrouble::kQuickStopAsked;
    if (torque_is_safely_off && by_itself) last_trouble_ = DriveTrouble::kSafeTorqueOff;
    return;
  }
  if (!status_.power) return Trip(DriveTrouble::kStatusUnclear, now);
  const PowerState power = *status_.power;
  const bool is_fault = power == PowerState::kFault || power == PowerState::kFaultReactionActive;
  // Whoever opens it wants the bench to stand, whether this drive has torque at the moment or not.
  if (torque_is_safely_off && (stage_ == DriveStage::kDisabled || IsOnTheWayUp())) {
    return Trip(DriveTrouble::kSafeTorqueOff, now);
  }
  switch (stage_) {
    case DriveStage::kDisabled:
      if (is_fault) Trip(DriveTrouble::kFault, now);
      break;
    case DriveStage::kChangingMode:
      if (is_fault) return Trip(DriveTrouble::kFault, now);
      if (power == PowerState::kQuickStopActive) return Trip(DriveTrouble::kStoppedByDrive, now);
      if (power == PowerState::kOperationEnabled) return;
      if (is_lowering_) {
        is_lowering_ = false;
        stage_since_ = now;
      }
      // The mode must have been asked for before what is displayed confirms it.
      if (outputs_.mode == static_cast<std::int8_t>(mode_) && status_.mode == mode_) {
        furthest_ = power;
        Enter(DriveStage::kRaising, now);
      }
      break;
    case DriveStage::kRaising:
      OnStatusRaising(power, now);
      break;
    case DriveStage::kEnabled:
      OnStatusEnabled(power, now);
      break;
    case DriveStage::kStopping:
      OnStatusStopping(power, now);
      break;
    case DriveStage::kResetting:
      if (reset_step_ == 2 && !is_fault) Enter(DriveStage::kDisabled, now);
      break;
    case DriveStage::kOff:
    case DriveStage::kCommissioning:
    case DriveStage::kStarting:
    case DriveStage::kStopped:
    case DriveStage::kSilent:
      break;
  }
}

void DriveMaster::OnStatusRaising(PowerState power, nanoseconds now) noexcept {
  switch (power) {
    case PowerState::kFault:
    case PowerState::kFaultReactionActive:
      return Trip(DriveTrouble::kFault, now);
    case PowerState::kQuickStopActive:
      return Trip(DriveTrouble::kStoppedByDrive, now);
    case PowerState::kNotReadyToSwitchOn:
    case PowerState::kSwitchOnDisabled:
    case PowerState::kReadyToSwitchOn:
    case PowerState::kSwitchedOn:
    case PowerState::kOperationEnabled:
      break;
  }
  if (status_.mode != mode_) return Trip(DriveTrouble::kModeNotConfirmed, now);
  if (power == PowerState::kOperationEnabled) return Enter(DriveStage::kEnabled, now);
  // Each state has its time; falling back and climbing again buys no more.
  if (power > furthest_) {
    furthest_ = power;
    stage_since_ = now;
  }
}

void DriveMaster::OnStatusEnabled(PowerState power, nanoseconds now) noexcept {
  if (power == PowerState::kFault || power == PowerState::kFaultReactionActive) {
    return Trip(DriveTrouble::kFault, now);
  }
  // Every frame counts: a quick stop that passes on to switch on disabled may show for one only.
  if (power != PowerState::kOperationEnabled) return Trip(DriveTrouble::kStoppedByDrive, now);
  if (status_.mode != mode_) return Trip(DriveTrouble::kModeNotConfirmed, now);
  if (status_.bits.following_error) return Trip(DriveTrouble::kFollowingError, now);
  if (status_.bits.homing_error) return Trip(DriveTrouble::kHomingFailed, now);
}

void DriveMaster::OnStatusStopping(PowerState power, nanoseconds now) noexcept {
  switch (power) {
    case PowerState::kOperationEnabled:
    case PowerState::kQuickStopActive:
    case PowerState::kFaultReactionActive:
      break;  // on its way
    case PowerState::kNotReadyToSwitchOn:
    case PowerState::kSwitchOnDisabled:
    case PowerState::kReadyToSwitchOn:
    case PowerState::kSwitchedOn:
    case PowerState::kFault:
      Enter(DriveStage::kStopped, now);
      break;
  }
}

}  // namespace strainwave::protocols::canopen
