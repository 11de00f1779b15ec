// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>

#include "protocols/can_frame.h"
#include "protocols/canopen/drive_motion.h"
#include "protocols/canopen/drive_objects.h"
#include "protocols/canopen/drive_physics.h"
#include "protocols/canopen/eds_file.h"
#include "protocols/canopen/emergency_producer.h"
#include "protocols/canopen/heartbeat_guard.h"
#include "protocols/canopen/nmt_slave.h"
#include "protocols/canopen/node_pdos.h"
#include "protocols/canopen/object_dictionary.h"
#include "protocols/canopen/power_stage.h"
#include "protocols/canopen/sdo_server.h"

namespace strainwave::protocols::canopen::device {

/// Misbehaviour put in by a test; each lasts until it is taken back. More: `DriveNode::Reboot`,
/// `RaiseEmergency`, `ObjectDictionary::Refuse`.
struct DriveFaults {
  bool heartbeat_stops{};
  bool silent{};  // as with the plug pulled: hears and says nothing, and goes on by itself
  std::optional<std::uint16_t> stuck_statusword{};
  std::optional<std::uint32_t> product_number{};  // of another drive, from the next reset on
  bool mode_not_confirmed{};                      // 6060h is taken, and nothing comes of it
  int pdo_length_change{};                        // bytes that each TPDO is longer or shorter
};

/// A servo drive on CANopen (CiA 301, CiA 402-2), without a bus: frames and time come in, frames come out.
///
/// What the standards leave to the maker:
/// - The connection counts as lost, and 6007h acts (0 nothing, 1 fault, 2 power off, 3 quick stop), when a
/// watched
///   heartbeat stays away (8130h), an RPDO with an event time stays away (8250h), SYNC stays away for twice
///   1006h (8700h), at bus-off, and when the master takes a node out of operational. 1029h:1 acts at
///   heartbeat and bus-off.
/// - Brake: while bit 0 of 60FEh:2 is 0 it is released in the powered states only. With that bit 1, bit 0 of
/// 60FEh:1
///   is the brake (1 engages), and the drive sets it by itself whenever it stops by itself: after a quick
///   stop, at a fault, when safe torque off opens. Bit 14 of the statusword says that the brake is engaged.
/// - Safe torque off open: bit 3 of 60FDh; the power goes off at once, and on under power there is error
/// 5440h.
///
/// `Poll` is called once a cycle of the drive, after the frames of that cycle; time never steps back.
class DriveNode {
 public:
  /// @throws std::invalid_argument for a bad node id and for an object that a drive needs and `eds` has not.
  DriveNode(const EdsFile& eds, std::uint8_t node_id, DrivePhysics& physics);
  DriveNode(const DriveNode&) = delete;
  DriveNode& operator=(const DriveNode&) = delete;

  void OnFrame(const CanFrame& frame, std::chrono::nanoseconds now);
  void Poll(std::chrono::nanoseconds now);
  /// The next frame to send; call until false.
  bool Next(CanFrame& frame);
  /// The controller gave up, or is back.
  void SetBusOff(bool off);

  NodeState node_state() const { return state_; }
  PowerState power_state() const { return power_.state(); }
  ObjectDictionary& objects() { return objects_; }

  DriveFaults& faults() { return faults_; }
  /// As after a dip of the supply: everything at its defaults, boot-up message with the next `Poll`.
  void Reboot();
  /// The position counter is set, as if the drive had come up after other turns; nothing moves.
  void CountFrom(std::int32_t position) { motion_.CountFrom(position); }
  void RaiseEmergency(std::uint16_t code, const std::array<std::uint8_t, 5>& vendor) {
    emergencies_.Raise(code, vendor);
  }
  void ClearEmergency(std::uint16_t code) { emergencies_.Clear(code); }

 private:
  void AddChecks();
  void OnNodeCommand(NodeCommand command);
  void OnSync(const CanFrame& frame);
  void OnControlword();
  void Reset(std::uint16_t first_index, std::uint16_t last_index);
  void ConnectionLost(ErrorCode code, bool error_behaviour);
  void Fault(ErrorCode code);
  void Supervise();
  /// An error that follows a condition; true at the moment it comes.
  bool Follow(ErrorCode code, bool condition);
  void StepDrive(double dt_s);
  void UpdateStatusword();
  void UpdateBrake();
  bool NextOf(CanFrame& frame);
  StopOptions Options() const;
  bool MayPower() const { return !reading_.safe_torque_off && !reading_.out_of_order; }

  ObjectDictionary objects_;
  std::uint8_t node_id_;
  DrivePhysics& physics_;
  EmergencyProducer emergencies_;
  HeartbeatGuard guard_;
  NodePdos pdos_;
  SdoServer sdo_;
  DriveObjects drive_;
  DriveMotion motion_;
  PowerStage power_;

  NodeState state_{NodeState::kInitialising};
  std::chrono::nanoseconds now_{};
  std::chrono::nanoseconds now_poll_{};
  bool polled_{};
  bool boot_up_due_{};
  bool heartbeat_due_{};
  std::optional<std::chrono::nanoseconds> last_heartbeat_;
  std::optional<std::chrono::nanoseconds> last_sync_;  // while operational
  bool bus_off_{};
  DriveMode mode_{DriveMode::kNone};
  DriveReading reading_;
  bool brake_engaged_{true};
  DriveFaults faults_;
};

}  // namespace strainwave::protocols::canopen::device
