// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "bench/devices/modbus/modbus_client.h"
#include "bench/devices/modbus/modbus_servo_profile.h"
#include "bench/realtime/latest.h"
#include "bench/roles/servo_drive.h"

namespace strainwave::bench {

/// The newest that a control thread wants of a drive.
struct ModbusServoCommand {
  bool enable{};
  bool quick{};  // a stop was the last that was asked for
  DriveMode mode{DriveMode::kTorque};
  double set_point{};
  bool brake_engaged{true};
  std::uint64_t enables{}, resets{};  // asked for until now
};

/// A servo drive on Modbus, in speed or torque mode. What is written is the newest command and never a queue:
/// after a stop there is no older set point that could still be sent.
///
/// Off is the state at the start, after every connection, after a fault and whenever its state is
/// uncertain; only a new `Enable` leads out of it, and only after one the brake can be released. The drive is
/// stopped (torque off, then brake on)
/// - when it is asked to be, at once;
/// - when nobody has called this object for `patience`: the control loop hangs;
/// - when the drive's own watchdog register does not follow what is written to it;
/// - as the last word on every way out.
/// Where the connection is gone, the drive's watchdog does it; so nothing is enabled unless the drive's
/// watchdog time reads back as it was written. That it works is proven by `ProveWatchdog`.
class ModbusServoDrive final : public ServoDrive, private ModbusDuties {
 public:
  /// @param clock  outlives the drive.
  /// @param others_supervised  asked before it is enabled, from a thread of its own; false refuses it, as
  ///   some drive of the bench would not notice that this program is gone. Nothing: there are no others.
  /// @throws std::invalid_argument for a map or profile that cannot be used.
  ModbusServoDrive(ModbusSettings settings, const protocols::modbus::RegisterMap& map,
                   const ModbusServoProfile& profile, const BenchClock& clock,
                   std::function<bool()> others_supervised = {},
                   std::chrono::nanoseconds patience = std::chrono::milliseconds(500));
  ~ModbusServoDrive() override = default;

  /// A position mode there is not: asked for it, the drive stays off.
  void Enable(DriveMode mode) noexcept override;
  void Disable() noexcept override;
  void QuickStop() noexcept override;
  void ResetFault() noexcept override;
  void SetBrake(bool engaged) noexcept override;
  void CommandSpeed(double speed_rad_per_s) noexcept override;
  void CommandPosition(double position_rad) noexcept override;
  void CommandTorque(double torque_Nm) noexcept override;
  /// Its time is that of the oldest of state, speed and torque when all of them were last good values; long
  /// ago where they never were.
  DriveActual Actual() const noexcept override;

  /// Why the drive does not do what it should, in words; empty while all is well. Not for the control thread.
  std::string trouble() const { return client_.trouble(); }
  const ModbusCounts& counts() const { return client_.counts(); }
  /// Connected, and its watchdog time read back as it was written.
  bool is_supervised() const noexcept { return is_supervised_; }
  /// As it reads back; nothing where that is not known. Other than `Actual()` no sign of life of a control
  /// loop.
  std::optional<bool> tells_brake_engaged() const noexcept;
  /// How often state, speed and torque are asked for, the slowest of them.
  std::chrono::nanoseconds poll_period() const;
  /// "in fault, code 17 (11h)"; empty while it says nothing of a fault. No sign of life of a control loop
  /// either.
  std::string fault() const;
  /// "product 402, serial 4711", as far as its map names them and it has said; empty where the map names
  /// none.
  std::string identity() const;

 private:
  using Command = ModbusServoCommand;
  static constexpr std::chrono::nanoseconds kLongAgo = -std::chrono::hours(1);

  std::chrono::nanoseconds WritePeriod() const override { return profile_.period; }
  ModbusReply Connected(ModbusLink& link, ModbusPoller& poller) override;
  ModbusReply Write(ModbusLink& link) override;
  void Lost() noexcept override;
  void Leave(ModbusLink& link) override;

  using Values = std::vector<std::pair<std::size_t, double>>;  // position in the map, value
  ModbusReply WriteStopped(ModbusLink& link, bool quick, const Values& rest);
  ModbusReply WriteStop(ModbusLink& link, bool quick, bool brake_engaged);
  ModbusReply SetWatchdogTime(ModbusLink& link);
  ModbusReply WriteCommand(ModbusLink& link, const Command& command, bool enable);
  std::optional<protocols::PowerState> PowerOf(double status) const noexcept;
  std::optional<protocols::PowerState> Power() const noexcept;  // nothing: not known by now
  bool IsEnabledAsAsked(std::optional<protocols::PowerState> power) const noexcept;
  double Position_rad() const noexcept;
  bool WatchdogFollows() const noexcept;
  void Order(bool at_once) noexcept;
  void Take(DriveMode mode, double value) noexcept;

  const protocols::modbus::RegisterMap map_;
  const ModbusServoProfile profile_;
  const ModbusServoRegisters at_;
  const BenchClock& clock_;
  const std::function<bool()> others_supervised_;
  const std::chrono::nanoseconds patience_;
  std::atomic<bool> is_supervised_{};

  // Of the control thread.
  Command mine_;
  mutable std::atomic<std::int64_t> heard_ns_;
  mutable std::atomic<std::int64_t> told_ns_{kLongAgo.count()};
  Latest<Command> command_;

  // Of the client's thread.
  ModbusPoller* poller_{};             // the client's, once it has connected
  std::atomic<double> counted_rad_{};  // the position, over the ends of its register
  std::uint64_t void_enables_{};       // asked for before something went wrong
  std::uint64_t resets_done_{};
  std::atomic<std::uint64_t> enables_begun_{};
  std::atomic<std::int64_t> begun_ns_{};  // when the last enabling began
  bool was_enabled_{};
  std::uint16_t count_{};  // last written to the watchdog register

  ModbusClient client_;  // last: its thread uses all of the above
};

}  // namespace strainwave::bench
