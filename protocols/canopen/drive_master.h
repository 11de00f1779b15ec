// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/can_frame.h"
#include "protocols/canopen/commissioning.h"
#include "protocols/canopen/drive_image.h"
#include "protocols/canopen/drive_profile.h"
#include "protocols/canopen/drive_trouble.h"
#include "protocols/canopen/emergency.h"
#include "protocols/canopen/frame_queue.h"
#include "protocols/canopen/heartbeat.h"
#include "protocols/canopen/set_points.h"
#include "protocols/canopen/sync.h"
#include "protocols/cia402.h"
#include "protocols/cia402_modes.h"

namespace strainwave::protocols::canopen {

/// Where a drive is, seen from the master.
enum class DriveStage : std::uint8_t {
  kOff,            // not set up, or lost; nothing but NMT and SDO may be sent
  kCommissioning,  // SDO
  kStarting,       // told to be operational, its first process data awaited
  kDisabled,       // ready for Enable
  kChangingMode,   // the mode is asked for, its confirmation awaited
  kRaising,        // through the power states, targets at the actual values
  kEnabled,        // follows set-points
  kStopping,       // quick stop on its way
  kStopped,        // voltage off, brake on; only ResetFault leads on
  kResetting,      // the edge of the fault reset
  kSilent,         // sends nothing by itself, to measure how the drive stops
};
std::string_view Name(DriveStage stage);

/// What becomes of a request that may be refused.
enum class DriveAnswer : std::uint8_t {
  kAccepted,
  kCommissionFirst,  // not set up, or a trouble after which settings are unknown
  kResetFirst,       // stopped, and nobody has reset it since
  kStillStopping,
  kDriveInFault,
  kModeNotInProfile,
  kDisableFirst,
  kStatusStale,
  kNotEnabledInMode,  // the set-point is of another mode, or operation is not enabled
  kNotANumber,
};
std::string_view Words(DriveAnswer answer);

/// What the drive says of itself, in SI at the axis. Only what came in within the stated number of SYNCs is
/// fresh; a stale value is not a value.
struct DriveStatus {
  std::chrono::nanoseconds time{};  // when the actual values came in
  bool is_stale{true};
  double position_rad{};
  double speed_rad_per_s{};
  double torque_Nm{};
  std::optional<PowerState> power;
  std::optional<OperationMode> mode;  // as 6061h displays it
  StatusBits bits;
  bool is_brake_engaged{true};               // by its feedback, else as commanded
  std::optional<bool> is_torque_safely_off;  // where the profile says how to know
  std::uint16_t error_code{};                // 603Fh, where mapped
};

/// Master of one CiA 402 drive, from power-on to motion, as a pure state machine: frames, SYNCs and time go
/// in, frames come out by `NextFrame`. A cycle is: OnFrame for what came in; requests; OnSync when SYNC goes
/// out; Poll; NextFrame until there is none. The adapter sends SYNC and the master's heartbeat for all
/// drives.
///
/// Any trouble stops the drive: what was queued is dropped, the quick stop goes out, the first reason is
/// kept. Motion then takes two deliberate acts: ResetFault (or Commission) and a new Enable. Nothing
/// allocates or throws but the constructor and what returns a string.
class DriveMaster {
 public:
  /// @throws std::invalid_argument with every finding of CheckProfile, or for a node_id that is none.
  DriveMaster(const DriveProfile& profile, std::uint8_t node_id);

  void OnFrame(const CanFrame& frame, std::chrono::nanoseconds now) noexcept;
  void OnSync(std::chrono::nanoseconds now) noexcept;
  void Poll(std::chrono::nanoseconds now) noexcept;
  std::optional<CanFrame> NextFrame(std::chrono::nanoseconds now) noexcept;
  /// True once after each stop: the adapter then drops what the bus has queued, before it takes NextFrame.
  bool TakePurge() noexcept;
  /// What the adapter learns when it sends: the bus is down, or takes no more.
  void OnBusOff(std::chrono::nanoseconds now) noexcept;
  void OnTransmitFull(std::chrono::nanoseconds now) noexcept;

  DriveAnswer Commission(std::chrono::nanoseconds now) noexcept;
  DriveAnswer Enable(OperationMode mode, std::chrono::nanoseconds now) noexcept;
  /// Torque off at once; the brake is not touched.
  void Disable(std::chrono::nanoseconds now) noexcept;
  void QuickStop(std::chrono::nanoseconds now) noexcept;
  DriveAnswer ResetFault(std::chrono::nanoseconds now) noexcept;
  /// Off the brake only while nothing is latched.
  DriveAnswer SetBrake(bool engaged) noexcept;
  DriveAnswer CommandSpeed(double speed_rad_per_s) noexcept;
  DriveAnswer CommandPosition(double position_rad) noexcept;
  DriveAnswer CommandTorque(double torque_Nm) noexcept;
  DriveAnswer StartHoming() noexcept;
  /// Sends nothing from now on, whatever happens, until QuickStop or Commission.
  void GoSilent() noexcept;

  DriveStage stage() const noexcept { return stage_; }
  /// Set up, every supervision of it read back as on, and nothing has happened since that would undo that.
  bool is_supervised() const noexcept { return !needs_commissioning_; }
  /// The first trouble since the last reset; a stop that was asked for only while there is no other.
  DriveTrouble trouble() const noexcept { return trouble_; }
  /// The newest one; differs from the first when more went wrong after it.
  DriveTrouble last_trouble() const noexcept { return last_trouble_; }
  /// The first trouble in words, with what the drive said of it.
  std::string TroubleWords() const;
  const DriveStatus& status() const noexcept { return status_; }
  const Commissioning& commissioning() const noexcept { return commissioning_; }
  std::optional<NmtState> nmt_state() const noexcept { return heartbeats_.state(); }
  /// The last emergency message, a taking back included.
  const std::optional<Emergency>& emergency() const noexcept { return emergency_; }
  SyncIntervals sync_intervals() const noexcept { return sync_.intervals(); }
  SyncIntervals TakeSyncIntervals() noexcept { return sync_.Take(); }
  /// Frames under this drive's identifiers that were not as long as they must be.
  std::uint64_t malformed_frames() const noexcept { return malformed_frames_; }

 private:
  struct Received {  // a PDO from the drive
    unsigned syncs_ago{};
    bool has_come{};
  };

  // What was so when the first trouble came.
  struct TripDetail {
    std::optional<PowerState> power;
    std::int8_t mode_display{};
    std::uint16_t error_code{};
    std::optional<Emergency> emergency;
    std::optional<NmtState> nmt_state;
    std::chrono::nanoseconds sync_interval{};
    std::uint32_t missing_cob_id{};
  };

  void Enter(DriveStage stage, std::chrono::nanoseconds now) noexcept;
  void Trip(DriveTrouble trouble, std::chrono::nanoseconds now) noexcept;
  bool IsExchanging() const noexcept;
  bool IsOnTheWayUp() const noexcept;
  bool HasPassed(std::chrono::nanoseconds time, std::chrono::nanoseconds now) const noexcept;
  bool Read(const BitSource& source) const noexcept;
  DriveAnswer MayCommand(bool is_of_mode) const noexcept;

  // drive_master_frames.cc: what comes in
  void OnHeartbeatEvent(HeartbeatEvent event, std::chrono::nanoseconds now) noexcept;
  void OnEmergency(const Emergency& emergency, std::chrono::nanoseconds now) noexcept;
  void KeepFromOperation() noexcept;
  void OnPdo(const CanFrame& frame, std::chrono::nanoseconds now) noexcept;
  void UpdateFreshness() noexcept;
  void UpdateStatus() noexcept;
  void OnStatus(std::chrono::nanoseconds now) noexcept;
  void OnStatusRaising(PowerState power, std::chrono::nanoseconds now) noexcept;
  void OnStatusEnabled(PowerState power, std::chrono::nanoseconds now) noexcept;
  void OnStatusStopping(PowerState power, std::chrono::nanoseconds now) noexcept;

  // drive_master_cycle.cc: what goes out, and what takes too long
  void PollCommissioning(std::chrono::nanoseconds now) noexcept;
  void SetOutputs(std::chrono::nanoseconds elapsed) noexcept;
  void SetBrakeOutput() noexcept;
  void QueuePdos(std::chrono::nanoseconds now) noexcept;

  DriveProfile profile_;
  std::uint8_t node_id_;
  std::vector<PdoSetting> pdos_;
  std::vector<Received> received_;  // beside pdos_
  Commissioning commissioning_;
  HeartbeatConsumer heartbeats_;
  SyncMeter sync_;
  SetPoints set_points_;
  FrameQueue<64> out_;        // one PDO of each kind at most
  int times_left_waiting_{};  // PDOs queued since it was last empty
  bool purge_due_{};

  DriveStage stage_{DriveStage::kOff};
  std::chrono::nanoseconds stage_since_{};
  DriveTrouble trouble_{DriveTrouble::kNone};
  DriveTrouble last_trouble_{DriveTrouble::kNone};
  TripDetail trip_;
  bool needs_commissioning_{true};
  OperationMode mode_{OperationMode::kNone};
  PowerState furthest_{};      // seen on the way up
  bool is_lowering_{};         // a mode change from operation enabled waits for the drive to leave it
  std::uint8_t reset_step_{};  // low, high, low
  std::optional<Emergency> emergency_;
  std::uint64_t malformed_frames_{};

  bool brake_engaged_{true};
  DriveInputs inputs_;
  DriveOutputs outputs_;
  DriveStatus status_;
  std::chrono::nanoseconds last_sync_{};
};

}  // namespace strainwave::protocols::canopen
