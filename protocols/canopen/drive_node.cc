// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/drive_node.h"

#include <algorithm>

#include "protocols/canopen/cob_ids.h"
#include "protocols/canopen/device_frames.h"

namespace strainwave::protocols::canopen::device {
namespace {

// Longer pauses of the program are no step of the drive's ramps.
constexpr std::chrono::nanoseconds kMostCycle = std::chrono::milliseconds(100);

enum class AbortOption : std::uint8_t { kNothing, kFault, kPowerOff, kQuickStop };  // 6007h
enum class ErrorBehaviour : std::uint8_t { kPreOperational, kNoChange, kStopped };  // 1029h:1

}  // namespace

DriveNode::DriveNode(const EdsFile& eds, std::uint8_t node_id, DrivePhysics& physics)
    : objects_(eds, node_id),
      node_id_(node_id),
      physics_(physics),
      emergencies_(objects_),
      guard_(objects_),
      pdos_(objects_, emergencies_),
      sdo_(objects_, node_id),
      drive_(objects_),
      motion_(drive_) {
  AddChecks();
}

void DriveNode::AddChecks() {
  objects_.CheckWrites({0x1005, 0}, [](std::int64_t value) -> std::optional<SdoAbort> {
    // No producer of SYNC, and no id of 29 bits.
    if ((value & ~(std::int64_t{0x80000000} | kStandardIdBits)) != 0) return SdoAbort::kInvalidValue;
    return std::nullopt;
  });
  objects_.CheckWrites({0x1014, 0}, [this](std::int64_t value) -> std::optional<SdoAbort> {
    constexpr std::int64_t kOff = 0x80000000;
    const std::int64_t now = objects_.Integer({0x1014, 0});
    if ((value & ~(kOff | kStandardIdBits)) != 0 || (value & kStandardIdBits) == 0)
      return SdoAbort::kInvalidValue;
    if ((now & kOff) == 0 && (value & kOff) == 0 && value != now) return SdoAbort::kInvalidValue;
    return std::nullopt;
  });
  if (objects_.Find({0x1019, 0}) != nullptr) {
    objects_.CheckWrites({0x1019, 0}, [this](std::int64_t value) -> std::optional<SdoAbort> {
      if (value == 1) return SdoAbort::kInvalidValue;
      // CiA 301, 7.5.2.22: not while SYNC is supervised.
      if (objects_.Integer({0x1006, 0}) != 0) return SdoAbort::kCannotStoreDeviceState;
      return std::nullopt;
    });
  }
  objects_.CheckWrites({0x6060, 0}, [this](std::int64_t value) -> std::optional<SdoAbort> {
    const std::optional<DriveMode> mode = DriveModeOf(value);
    if (!mode || !drive_.Supports(*mode)) return SdoAbort::kInvalidValue;
    return std::nullopt;
  });
  objects_.CheckWrites({0x6098, 0}, [](std::int64_t value) -> std::optional<SdoAbort> {
    if (value == 36) return SdoAbort::kInvalidValue;  // of the methods between its limits there are 35 and 37
    return std::nullopt;
  });
  objects_.CheckWrites({0x605A, 0}, [](std::int64_t value) -> std::optional<SdoAbort> {
    if (value == 3 || value == 4) return SdoAbort::kInvalidValue;  // at the current or voltage limit
    return std::nullopt;
  });
}

StopOptions DriveNode::Options() const {
  return {static_cast<int>(drive_.quick_stop_option.integer()),
          static_cast<int>(drive_.fault_reaction_option.integer())};
}

void DriveNode::Reset(std::uint16_t first_index, std::uint16_t last_index) {
  if (power_.powered()) power_.DisableVoltage();
  objects_.Restore(first_index, last_index);
  if (faults_.product_number) objects_.At({0x1018, 2}).Set(*faults_.product_number);
  emergencies_.Reset();
  guard_.Reset();
  pdos_.Start();
  sdo_.Reset();
  last_heartbeat_.reset();
  last_sync_.reset();
  boot_up_due_ = heartbeat_due_ = false;
  brake_engaged_ = true;
  physics_.Command({});
  state_ = NodeState::kInitialising;
}

void DriveNode::Reboot() {
  power_ = {};
  Reset(0x1000, 0xFFFF);
}

void DriveNode::OnNodeCommand(NodeCommand command) {
  const NodeState before = state_;
  state_ = NextNodeState(state_, command);
  if (command == NodeCommand::kResetNode) return Reboot();
  if (command == NodeCommand::kResetCommunication) return Reset(0x1000, 0x1FFF);
  if (state_ == before) return;
  if (state_ == NodeState::kOperational) {
    pdos_.Start();
    last_sync_.reset();
  }
  if (state_ == NodeState::kStopped) sdo_.Reset();
  if (before == NodeState::kOperational) ConnectionLost(ErrorCode::kCommunication, false);
}

void DriveNode::OnFrame(const CanFrame& frame, std::chrono::nanoseconds now) {
  now_ = now;
  if (faults_.silent || state_ == NodeState::kInitialising || !IsPlainData(frame)) return;
  if (const std::optional<NodeCommand> command = CommandTo(node_id_, frame)) return OnNodeCommand(*command);
  guard_.OnFrame(frame, now);
  if (state_ == NodeState::kOperational) {
    if (frame.id == (objects_.Integer({0x1005, 0}) & kStandardIdBits)) return OnSync(frame);
    if (pdos_.OnFrame(frame, now)) OnControlword();
  }
  if (state_ != NodeState::kStopped && sdo_.OnFrame(frame, now)) OnControlword();
}

void DriveNode::OnSync(const CanFrame& frame) {
  // A byte with the counter where there is one (1019h). Which number it has concerns only PDOs with a start
  // value, which this drive has none of.
  const bool is_wrong = frame.length != (objects_.Integer({0x1019, 0}) != 0 ? 1 : 0);
  if (Follow(ErrorCode::kSyncLength, is_wrong) || is_wrong) return;
  last_sync_ = now_;
  if (pdos_.OnSync()) OnControlword();
  reading_ = physics_.Read();
  motion_.Report(reading_);
  UpdateStatusword();
  pdos_.SampleOnSync();
}

void DriveNode::OnControlword() {
  const PowerState before = power_.state();
  const auto controlword = static_cast<std::uint16_t>(drive_.controlword.integer());
  if (power_.IsResetBy(controlword)) {
    physics_.ResetFault();
    reading_ = physics_.Read();
  }
  const bool lost = guard_.lost() || pdos_.timed_out() || bus_off_;
  const bool cause_lasts =
      reading_.out_of_order ||
      (lost && static_cast<AbortOption>(drive_.abort_option.integer()) == AbortOption::kFault);
  power_.OnControlword(controlword, Options(), MayPower(), cause_lasts);
  if (before != PowerState::kFault || power_.state() == before) return;
  for (const ErrorCode code : {ErrorCode::kFollowingError, ErrorCode::kSafeTorqueOff,
                               ErrorCode::kDeviceSoftware, ErrorCode::kCommunication}) {
    emergencies_.Clear(code);
  }
  drive_.error_code.Set(0);
}

void DriveNode::Fault(ErrorCode code) {
  drive_.error_code.Set(static_cast<std::int64_t>(code));
  emergencies_.Raise(code);
  power_.Fault(Options());
}

void DriveNode::ConnectionLost(ErrorCode code, bool error_behaviour) {
  switch (static_cast<AbortOption>(drive_.abort_option.integer())) {
    case AbortOption::kNothing:
      break;
    case AbortOption::kFault:
      if (power_.powered()) Fault(code);
      break;
    case AbortOption::kPowerOff:
      power_.DisableVoltage();
      break;
    case AbortOption::kQuickStop:
      power_.QuickStop();
      break;
  }
  if (!error_behaviour) return;
  switch (static_cast<ErrorBehaviour>(objects_.Integer({0x1029, 1}))) {
    case ErrorBehaviour::kPreOperational:
      if (state_ == NodeState::kOperational) state_ = NodeState::kPreOperational;
      break;
    case ErrorBehaviour::kNoChange:
      break;
    case ErrorBehaviour::kStopped:
      if (state_ != NodeState::kInitialising) state_ = NodeState::kStopped;
      break;
  }
}

bool DriveNode::Follow(ErrorCode code, bool condition) {
  const bool before = emergencies_.lasts(code);
  if (condition) {
    emergencies_.Raise(code);
  } else {
    emergencies_.Clear(code);
  }
  return condition && !before;
}

void DriveNode::SetBusOff(bool off) {
  if (off && !bus_off_) {
    ConnectionLost(ErrorCode::kRecoveredFromBusOff, true);
  } else if (!off && bus_off_) {
    emergencies_.Raise(ErrorCode::kRecoveredFromBusOff);
    emergencies_.Clear(ErrorCode::kRecoveredFromBusOff);
  }
  bus_off_ = off;
}

void DriveNode::Supervise() {
  guard_.Poll(now_);
  if (Follow(ErrorCode::kHeartbeat, guard_.lost())) ConnectionLost(ErrorCode::kHeartbeat, true);
  if (state_ != NodeState::kOperational) return;
  pdos_.Supervise(now_);
  if (Follow(ErrorCode::kRpdoTimeout, pdos_.timed_out())) ConnectionLost(ErrorCode::kRpdoTimeout, false);
  const std::chrono::microseconds period(objects_.Integer({0x1006, 0}));
  const bool missing = period.count() != 0 && last_sync_ && now_ - *last_sync_ > 2 * period;
  if (Follow(ErrorCode::kSyncMissing, missing)) ConnectionLost(ErrorCode::kSyncMissing, false);
}

void DriveNode::Poll(std::chrono::nanoseconds now) {
  const std::chrono::nanoseconds cycle =
      polled_ ? std::min(now - now_poll_, kMostCycle) : std::chrono::nanoseconds{};
  now_ = now_poll_ = now;
  polled_ = true;
  if (state_ == NodeState::kInitialising) {
    if (faults_.product_number) objects_.At({0x1018, 2}).Set(*faults_.product_number);
    state_ = NodeState::kPreOperational;
    boot_up_due_ = true;
    last_heartbeat_ = now;
  }
  const std::chrono::milliseconds heartbeat(objects_.Integer({0x1017, 0}));
  if (!last_heartbeat_ || now - *last_heartbeat_ >= heartbeat) {
    last_heartbeat_ = now;
    heartbeat_due_ = heartbeat.count() != 0 && !faults_.heartbeat_stops;
  }
  pdos_.set_length_change(faults_.pdo_length_change);
  Supervise();  // first, so that a stop begins in this cycle
  StepDrive(std::chrono::duration<double>(cycle).count());
  if (state_ == NodeState::kOperational) pdos_.SampleOnEvent(now);
  sdo_.Poll(now);
}

void DriveNode::StepDrive(double dt_s) {
  reading_ = physics_.Read();
  if (reading_.out_of_order && power_.state() != PowerState::kFault) {
    Fault(ErrorCode::kDeviceSoftware);
    power_.DisableVoltage();  // there is nothing left to ramp down with
  }
  if (reading_.safe_torque_off) {
    if (power_.powered()) emergencies_.Raise(ErrorCode::kSafeTorqueOff);
    power_.DisableVoltage();
  } else {
    emergencies_.Clear(ErrorCode::kSafeTorqueOff);
  }
  drive_.inputs.Set(reading_.safe_torque_off ? 1 << 3 : 0);
  OnControlword();
  power_.Step(Options(), motion_.stopped());

  const DriveMode asked = DriveModeOf(drive_.mode.integer()).value_or(DriveMode::kNone);
  if (!faults_.mode_not_confirmed) mode_ = asked;
  drive_.mode_display.Set(static_cast<std::int64_t>(mode_));
  DriveCommand command = motion_.Step(dt_s, power_.state(), mode_, Options(), reading_);
  if (motion_.following_error()) Fault(ErrorCode::kFollowingError);
  if (!power_.powered()) command = {};
  UpdateBrake();
  command.brake_engaged = brake_engaged_;
  physics_.Command(command);
  UpdateStatusword();
}

void DriveNode::UpdateBrake() {
  const bool by_master = (drive_.outputs_mask.integer() & 1) != 0;
  if (power_.TakeBrakeRequest()) drive_.outputs.Set(drive_.outputs.integer() | 1);
  brake_engaged_ = by_master ? (drive_.outputs.integer() & 1) != 0 : !power_.powered();
}

void DriveNode::UpdateStatusword() {
  unsigned word = 0;
  switch (power_.state()) {
    case PowerState::kNotReadyToSwitchOn:
      word = 0x00;
      break;
    case PowerState::kSwitchOnDisabled:
      word = 0x40;
      break;
    case PowerState::kReadyToSwitchOn:
      word = 0x21;
      break;
    case PowerState::kSwitchedOn:
      word = 0x23;
      break;
    case PowerState::kOperationEnabled:
      word = 0x27;
      break;
    case PowerState::kQuickStopActive:
      word = 0x07;
      break;
    case PowerState::kFaultReactionActive:
      word = 0x0F;
      break;
    case PowerState::kFault:
      word = 0x08;
      break;
  }
  constexpr unsigned kVoltageEnabled = 1U << 4;
  constexpr unsigned kRemote = 1U << 9;
  constexpr unsigned kBrakeEngaged = 1U << 14;
  if (MayPower()) word |= kVoltageEnabled;
  if (state_ == NodeState::kOperational) word |= kRemote;
  if (brake_engaged_) word |= kBrakeEngaged;
  word |= motion_.status_bits();
  drive_.statusword.Set(faults_.stuck_statusword.value_or(static_cast<std::uint16_t>(word)));
}

bool DriveNode::NextOf(CanFrame& frame) {
  const std::uint8_t state = boot_up_due_ ? 0 : static_cast<std::uint8_t>(state_);
  if (boot_up_due_ || heartbeat_due_) {
    (boot_up_due_ ? boot_up_due_ : heartbeat_due_) = false;
    frame = DataFrame(kHeartbeatBase + node_id_, std::span(&state, 1));
    return true;
  }
  const bool talks = state_ == NodeState::kPreOperational || state_ == NodeState::kOperational;
  if (talks && emergencies_.Next(now_, frame)) return true;
  if (state_ == NodeState::kOperational && pdos_.Next(frame)) return true;
  return talks && sdo_.Next(frame);
}

bool DriveNode::Next(CanFrame& frame) {
  if (!faults_.silent) return NextOf(frame);
  // What is said meanwhile is said to nobody, and not later.
  while (NextOf(frame)) continue;
  return false;
}

}  // namespace strainwave::protocols::canopen::device
