// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/drive_master.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace strainwave::protocols::canopen {
namespace {

using std::chrono::nanoseconds;

const DriveProfile& Sound(const DriveProfile& profile) {
  const std::vector<std::string> findings = CheckProfile(profile);
  if (!findings.empty()) {
    throw std::invalid_argument(fmt::format("profile '{}': {}", profile.name, fmt::join(findings, "; ")));
  }
  return profile;
}

}  // namespace

DriveMaster::DriveMaster(const DriveProfile& profile, std::uint8_t node_id)
    : profile_(Sound(profile)),
      node_id_(node_id),
      pdos_(PdosOf(profile, node_id)),
      received_(pdos_.size()),
      commissioning_(CommissioningSteps(profile, node_id), node_id, profile.timing.sdo_timeout),
      heartbeats_(node_id, std::chrono::milliseconds(profile.supervision.drive_timeout_ms)),
      set_points_(profile) {
  outputs_.mode = static_cast<std::int8_t>(profile_.modes.front());
}

void DriveMaster::Enter(DriveStage stage, nanoseconds now) noexcept {
  stage_ = stage;
  stage_since_ = now;
  if (stage == DriveStage::kOff) heartbeats_.Stop();
  // A stop that waited for the shaft to stand has come to its end.
  if (stage == DriveStage::kStopped) brake_engaged_ = true;
}

bool DriveMaster::HasPassed(nanoseconds time, nanoseconds now) const noexcept {
  return now - stage_since_ >= time;
}

bool DriveMaster::IsExchanging() const noexcept {
  switch (stage_) {
    case DriveStage::kOff:
    case DriveStage::kCommissioning:
    case DriveStage::kStarting:
    case DriveStage::kSilent:
      return false;
    case DriveStage::kDisabled:
    case DriveStage::kChangingMode:
    case DriveStage::kRaising:
    case DriveStage::kEnabled:
    case DriveStage::kStopping:
    case DriveStage::kStopped:
    case DriveStage::kResetting:
      return true;
  }
  return false;
}

bool DriveMaster::IsOnTheWayUp() const noexcept {
  return stage_ == DriveStage::kChangingMode || stage_ == DriveStage::kRaising ||
         stage_ == DriveStage::kEnabled;
}

void DriveMaster::Trip(DriveTrouble trouble, nanoseconds now) noexcept {
  // What the drive does while it stands after a stop that was asked for is the reason from then on.
  const bool is_asked = trouble == DriveTrouble::kQuickStopAsked;
  const bool stands_as_asked = trouble_ == DriveTrouble::kQuickStopAsked && stage_ == DriveStage::kStopped;
  if (trouble_ == DriveTrouble::kNone || (stands_as_asked && !is_asked)) {
    trouble_ = trouble;
    trip_.power = status_.power;
    trip_.mode_display = inputs_.mode_display;
    trip_.error_code = inputs_.error_code;
    trip_.emergency = emergency_;
    trip_.nmt_state = heartbeats_.state();
  }
  if (!is_asked || trouble_ == DriveTrouble::kQuickStopAsked) last_trouble_ = trouble;
  needs_commissioning_ = needs_commissioning_ || NeedsCommissioning(trouble);
  if (stage_ == DriveStage::kSilent) return;

  out_.Purge();
  purge_due_ = true;
  set_points_.Hold(inputs_, outputs_);
  if (!profile_.brake.waits_for_standstill) brake_engaged_ = true;
  if (commissioning_.state() == Commissioning::State::kRunning) commissioning_.Abandon();
  if (!IsExchanging() || trouble == DriveTrouble::kBusOff || trouble == DriveTrouble::kNodeRebooted) {
    // What the drive would make of a PDO is not known, or nothing can be sent at all.
    return Enter(DriveStage::kOff, now);
  }
  if (stage_ != DriveStage::kStopping && stage_ != DriveStage::kStopped) Enter(DriveStage::kStopping, now);
  SetOutputs(nanoseconds::zero());
  QueuePdos(now);
}

bool DriveMaster::TakePurge() noexcept { return std::exchange(purge_due_, false); }

void DriveMaster::OnBusOff(nanoseconds now) noexcept { Trip(DriveTrouble::kBusOff, now); }

void DriveMaster::OnTransmitFull(nanoseconds now) noexcept { Trip(DriveTrouble::kTransmitQueueFull, now); }

DriveAnswer DriveMaster::Commission(nanoseconds now) noexcept {
  if (stage_ == DriveStage::kStopping || stage_ == DriveStage::kResetting) return DriveAnswer::kStillStopping;
  if (IsOnTheWayUp()) return DriveAnswer::kDisableFirst;
  out_.Purge();
  trouble_ = last_trouble_ = DriveTrouble::kNone;
  needs_commissioning_ = true;
  heartbeats_.Stop();
  std::fill(received_.begin(), received_.end(), Received{});
  UpdateFreshness();
  Enter(DriveStage::kCommissioning, now);
  (void)out_.Push(NmtFrame(NmtCommand::kEnterPreOperational, node_id_));
  commissioning_.Start(now);
  return DriveAnswer::kAccepted;
}

DriveAnswer DriveMaster::Enable(OperationMode mode, nanoseconds now) noexcept {
  switch (stage_) {
    case DriveStage::kOff:
    case DriveStage::kCommissioning:
    case DriveStage::kStarting:
    case DriveStage::kSilent:
      return DriveAnswer::kCommissionFirst;
    case DriveStage::kStopping:
      return DriveAnswer::kStillStopping;
    case DriveStage::kStopped:
    case DriveStage::kResetting:
      return needs_commissioning_ ? DriveAnswer::kCommissionFirst : DriveAnswer::kResetFirst;
    case DriveStage::kDisabled:
    case DriveStage::kChangingMode:
    case DriveStage::kRaising:
    case DriveStage::kEnabled:
      break;
  }
  if (std::find(profile_.modes.begin(), profile_.modes.end(), mode) == profile_.modes.end()) {
    return DriveAnswer::kModeNotInProfile;
  }
  if (status_.is_stale) return DriveAnswer::kStatusStale;
  if (status_.power == PowerState::kFault || status_.power == PowerState::kFaultReactionActive) {
    return DriveAnswer::kDriveInFault;
  }
  if (IsOnTheWayUp() && mode == mode_) return DriveAnswer::kAccepted;
  mode_ = mode;
  is_lowering_ = status_.power == PowerState::kOperationEnabled;
  Enter(DriveStage::kChangingMode, now);
  return DriveAnswer::kAccepted;
}

void DriveMaster::Disable(nanoseconds now) noexcept {
  if (!IsOnTheWayUp()) return;
  out_.Purge();
  purge_due_ = true;
  Enter(DriveStage::kDisabled, now);
  SetOutputs(nanoseconds::zero());
  QueuePdos(now);
}

void DriveMaster::QuickStop(nanoseconds now) noexcept {
  // A measurement of silence is not worth a stop that somebody asks for.
  if (stage_ == DriveStage::kSilent) Enter(DriveStage::kStopping, now);
  if (stage_ != DriveStage::kOff) Trip(DriveTrouble::kQuickStopAsked, now);
}

DriveAnswer DriveMaster::ResetFault(nanoseconds now) noexcept {
  if (needs_commissioning_) return DriveAnswer::kCommissionFirst;
  if (stage_ == DriveStage::kStopping) return DriveAnswer::kStillStopping;
  if (stage_ != DriveStage::kStopped) return DriveAnswer::kAccepted;
  if (status_.is_stale) return DriveAnswer::kStatusStale;
  if (status_.power == PowerState::kFaultReactionActive) return DriveAnswer::kStillStopping;
  trouble_ = last_trouble_ = DriveTrouble::kNone;
  reset_step_ = 0;
  Enter(status_.power == PowerState::kFault ? DriveStage::kResetting : DriveStage::kDisabled, now);
  return DriveAnswer::kAccepted;
}

DriveAnswer DriveMaster::SetBrake(bool engaged) noexcept {
  if (!engaged && !IsExchanging()) return DriveAnswer::kCommissionFirst;
  if (!engaged && stage_ != DriveStage::kDisabled && !IsOnTheWayUp()) return DriveAnswer::kResetFirst;
  brake_engaged_ = engaged;
  return DriveAnswer::kAccepted;
}

DriveAnswer DriveMaster::MayCommand(bool is_of_mode) const noexcept {
  return stage_ == DriveStage::kEnabled && is_of_mode ? DriveAnswer::kAccepted
                                                      : DriveAnswer::kNotEnabledInMode;
}

DriveAnswer DriveMaster::CommandSpeed(double speed_rad_per_s) noexcept {
  const DriveAnswer answer =
      MayCommand(mode_ == OperationMode::kProfileVelocity || mode_ == OperationMode::kCyclicVelocity);
  if (answer != DriveAnswer::kAccepted) return answer;
  return set_points_.AskSpeed(speed_rad_per_s) ? answer : DriveAnswer::kNotANumber;
}

DriveAnswer DriveMaster::CommandPosition(double position_rad) noexcept {
  const DriveAnswer answer =
      MayCommand(mode_ == OperationMode::kProfilePosition || mode_ == OperationMode::kCyclicPosition);
  if (answer != DriveAnswer::kAccepted) return answer;
  return set_points_.AskPosition(position_rad, inputs_) ? answer : DriveAnswer::kNotANumber;
}

DriveAnswer DriveMaster::CommandTorque(double torque_Nm) noexcept {
  const DriveAnswer answer =
      MayCommand(mode_ == OperationMode::kProfileTorque || mode_ == OperationMode::kCyclicTorque);
  if (answer != DriveAnswer::kAccepted) return answer;
  return set_points_.AskTorque(torque_Nm) ? answer : DriveAnswer::kNotANumber;
}

DriveAnswer DriveMaster::StartHoming() noexcept {
  const DriveAnswer answer = MayCommand(mode_ == OperationMode::kHoming);
  if (answer == DriveAnswer::kAccepted) set_points_.AskHoming();
  return answer;
}

void DriveMaster::GoSilent() noexcept {
  out_.Purge();
  purge_due_ = true;
  commissioning_.Abandon();
  needs_commissioning_ = true;
  stage_ = DriveStage::kSilent;
}

}  // namespace strainwave::protocols::canopen
