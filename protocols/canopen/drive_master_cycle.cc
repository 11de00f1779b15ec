// SPDX-License-Identifier: Apache-2.0
// What goes out with each SYNC, and what takes too long.
#include <algorithm>
#include <cmath>

#include "protocols/canopen/drive_master.h"

namespace strainwave::protocols::canopen {
namespace {

using std::chrono::nanoseconds;

constexpr std::uint16_t kControlwordEnabled = 0x000F;
constexpr std::uint16_t kControlwordSwitchedOn = 0x0007;
constexpr int kMostTimesLeftWaiting = 20;  // 80 ms of the usual 4 ms

}  // namespace

void DriveMaster::OnSync(nanoseconds now) noexcept {
  const std::optional<nanoseconds> interval = sync_.OnSync(now);
  last_sync_ = now;
  for (Received& received : received_) {
    if (received.has_come && received.syncs_ago < ~0U) ++received.syncs_ago;
  }
  UpdateFreshness();
  if (!IsExchanging()) return;

  const DriveTiming& timing = profile_.timing;
  const nanoseconds deviation = interval ? std::chrono::abs(*interval - timing.sync_period) : nanoseconds{};
  if (deviation > timing.most_sync_deviation && IsOnTheWayUp()) {
    trip_.sync_interval = *interval;
    return Trip(DriveTrouble::kSyncJitter, now);
  }
  if (status_.is_stale && (stage_ == DriveStage::kDisabled || IsOnTheWayUp())) {
    return Trip(DriveTrouble::kPdoMissing, now);
  }
  // Some option codes end in quick stop active with torque on (605Ah: 5 to 8).
  if (stage_ == DriveStage::kStopping && status_.power == PowerState::kQuickStopActive && !status_.is_stale &&
      std::abs(status_.speed_rad_per_s) < profile_.limits.standstill_speed_rad_per_s) {
    Enter(DriveStage::kStopped, now);
  }
  if (stage_ == DriveStage::kResetting && reset_step_ < 2 &&
      HasPassed((reset_step_ + 1) * timing.reset_hold, now)) {
    ++reset_step_;
  }
  // After a gap in SYNC a set-point is not led further than in two periods.
  SetOutputs(std::min(interval.value_or(nanoseconds::zero()), 2 * timing.sync_period));
  QueuePdos(now);
}

void DriveMaster::SetOutputs(nanoseconds elapsed) noexcept {
  if (stage_ != DriveStage::kEnabled) set_points_.Hold(inputs_, outputs_);
  switch (stage_) {
    case DriveStage::kOff:
    case DriveStage::kCommissioning:
    case DriveStage::kStarting:
    case DriveStage::kSilent:
    case DriveStage::kDisabled:
    case DriveStage::kStopped:
      outputs_.controlword = kControlwordDisableVoltage;
      break;
    case DriveStage::kChangingMode:
      // From operation enabled the drive goes down by its ramp (605Ch) before it is given another mode.
      outputs_.controlword = is_lowering_ ? kControlwordSwitchedOn : kControlwordDisableVoltage;
      if (!is_lowering_) outputs_.mode = static_cast<std::int8_t>(mode_);
      break;
    case DriveStage::kRaising:
      outputs_.controlword = ControlwordTowardsEnabled(*status_.power).value_or(kControlwordDisableVoltage);
      break;
    case DriveStage::kEnabled:
      outputs_.controlword = kControlwordEnabled;
      set_points_.Step(mode_, inputs_.statusword, elapsed, outputs_);
      break;
    case DriveStage::kStopping:
      outputs_.controlword = kControlwordQuickStop;
      break;
    case DriveStage::kResetting:
      outputs_.controlword = reset_step_ == 1 ? kControlwordFaultReset : kControlwordDisableVoltage;
      break;
  }
  SetBrakeOutput();
}

void DriveMaster::SetBrakeOutput() noexcept {
  if (profile_.brake.engaged_feedback.from == BitSource::From::kNowhere) {
    status_.is_brake_engaged = brake_engaged_;
  }
  const bool is_high = brake_engaged_ == profile_.brake.engages_when_high;
  const std::uint32_t bits = is_high ? profile_.brake.mask : 0;
  switch (profile_.brake.by) {
    case BrakeControl::By::kDrive:
      break;
    case BrakeControl::By::kControlword:
      outputs_.controlword = static_cast<std::uint16_t>(outputs_.controlword | bits);
      break;
    case BrakeControl::By::kDigitalOutput:
      outputs_.digital_outputs = bits;
      break;
  }
}

void DriveMaster::QueuePdos(nanoseconds now) noexcept {
  if (++times_left_waiting_ > kMostTimesLeftWaiting) {
    // Nobody takes the frames out.
    times_left_waiting_ = 0;
    return Trip(DriveTrouble::kTransmitQueueFull, now);
  }
  for (const PdoSetting& pdo : pdos_) {
    if (pdo.flow != PdoFlow::kToDrive) continue;
    const std::optional<CanFrame> frame = EncodeToDrive(pdo, outputs_);
    if (frame) (void)out_.PushNewest(*frame);
  }
}

std::optional<CanFrame> DriveMaster::NextFrame(nanoseconds now) noexcept {
  if (const std::optional<CanFrame> frame = out_.Pop()) return frame;
  times_left_waiting_ = 0;
  if (stage_ == DriveStage::kCommissioning) return commissioning_.Poll(now);
  return std::nullopt;
}

void DriveMaster::PollCommissioning(nanoseconds now) noexcept {
  switch (commissioning_.state()) {
    case Commissioning::State::kDone:
      (void)out_.Push(NmtFrame(NmtCommand::kStart, node_id_));
      heartbeats_.Start(now);
      Enter(DriveStage::kStarting, now);
      break;
    case Commissioning::State::kFailed:
      Trip(DriveTrouble::kCommissioningFailed, now);
      break;
    case Commissioning::State::kIdle:
    case Commissioning::State::kRunning:
      break;
  }
}

void DriveMaster::Poll(nanoseconds now) noexcept {
  if (const auto event = heartbeats_.Poll(now)) OnHeartbeatEvent(*event, now);
  const DriveTiming& timing = profile_.timing;
  switch (stage_) {
    case DriveStage::kCommissioning:
      PollCommissioning(now);
      break;
    case DriveStage::kStarting:
      if (heartbeats_.state() == NmtState::kOperational && !status_.is_stale) {
        needs_commissioning_ = false;
        Enter(DriveStage::kDisabled, now);
        OnStatus(now);
      } else if (HasPassed(timing.start_timeout, now)) {
        Trip(DriveTrouble::kNotOperational, now);
      }
      break;
    case DriveStage::kDisabled:
      if (status_.power == PowerState::kOperationEnabled && HasPassed(timing.stage_timeout, now)) {
        Trip(DriveTrouble::kStaysEnabled, now);
      }
      break;
    case DriveStage::kChangingMode:
      if (is_lowering_ && HasPassed(timing.stop_timeout, now)) {
        Trip(DriveTrouble::kStaysEnabled, now);
      } else if (!is_lowering_ && HasPassed(timing.mode_timeout, now)) {
        Trip(DriveTrouble::kModeNotConfirmed, now);
      }
      break;
    case DriveStage::kRaising:
      if (HasPassed(timing.stage_timeout, now)) Trip(DriveTrouble::kEnableTimedOut, now);
      break;
    case DriveStage::kStopping:
      if (HasPassed(timing.stop_timeout, now)) {
        if (!status_.is_stale && status_.power == PowerState::kOperationEnabled) {
          last_trouble_ = DriveTrouble::kStaysEnabled;
        }
        Enter(DriveStage::kStopped, now);
      }
      break;
    case DriveStage::kResetting:
      if (HasPassed(2 * timing.reset_hold + timing.stage_timeout, now)) {
        Trip(DriveTrouble::kFaultNotReset, now);
      }
      break;
    case DriveStage::kOff:
    case DriveStage::kEnabled:
    case DriveStage::kStopped:
    case DriveStage::kSilent:
      break;
  }
}

}  // namespace strainwave::protocols::canopen
