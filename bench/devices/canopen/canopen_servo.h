// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>

#include "bench/devices/wake.h"
#include "bench/realtime/latest.h"
#include "bench/roles/bench_clock.h"
#include "bench/roles/servo_drive.h"
#include "protocols/canopen/drive_master.h"

namespace strainwave::bench {

struct CanopenServoSettings {
  std::string name;  // for people: "driving servo"
  protocols::canopen::DriveProfile profile;
  std::uint8_t node_id{};
  /// A control loop that asks for nothing for so long while the drive is on its way or enabled is gone.
  std::chrono::nanoseconds longest_silence{std::chrono::milliseconds(200)};
};

/// What is known of a drive, for people and reports.
struct ServoReport {
  protocols::canopen::DriveStage stage{};
  protocols::canopen::DriveTrouble trouble{};
  std::uint32_t commissions{};  // asked for so far and begun
  std::uint32_t steps_done{};   // of the newest one
  std::uint32_t steps{};
  bool supervised{};  // it would notice that the master is gone, by what it read back
  bool heard{};       // lately: brake and torque-off are of now
  bool brake_engaged{true};
  bool torque_off_known{};  // `torque_safely_off` says something
  bool torque_safely_off{};
  std::array<char, 240> words{};  // of the trouble, ended by a zero
};

/// What the bench wants of a drive: what was asked for last, and how often each thing was.
struct ServoOrders {
  std::uint32_t stops{};
  std::uint32_t resets{};
  std::uint32_t lowerings{};  // Disable
  std::uint32_t raisings{};   // Enable
  bool raise{};               // the last of the four was Enable
  DriveMode mode{};
  bool has_set_point{};
  double set_point{};
  bool brake_engaged{true};
};

/// What the drive says, and the newest order to enable it that had been taken by then.
struct ServoAnswer {
  DriveActual actual;
  std::uint32_t raisings{};
};

/// A CiA 402 drive in the role of a servo: the control thread leaves orders, the bus thread takes the newest
/// ones to the drive's master and publishes what became of them. Orders are states, not messages: of what was
/// asked before a stop nothing is left after it.
///
/// A stop that the bench itself asked for is the end of every phase; `Enable` resets it. Every other trouble
/// reads as power state fault until `ResetFault`, or a new commissioning, is asked for.
class CanopenServo final : public ServoDrive {
 public:
  enum class Holder : std::uint8_t { kPendant = 1, kEndOfProgram = 2 };

  /// @throws std::invalid_argument as DriveMaster does, or for a profile without a mode for speed, position
  ///   and torque.
  CanopenServo(CanopenServoSettings settings, const BenchClock& clock);

  // From the control thread.
  void Enable(DriveMode mode) noexcept override;
  void Disable() noexcept override;
  void QuickStop() noexcept override;
  void ResetFault() noexcept override;
  void SetBrake(bool engaged) noexcept override;
  void CommandSpeed(double speed_rad_per_s) noexcept override;
  void CommandPosition(double position_rad) noexcept override;
  void CommandTorque(double torque_Nm) noexcept override;
  DriveActual Actual() const noexcept override;

  // From any thread.
  /// @return what `ServoReport::commissions` shows once it has begun.
  std::uint32_t Commission() noexcept { return commissions_.fetch_add(1) + 1; }
  /// Stops the drive and keeps it stopped as long as somebody holds it, for whoever else may stop the bench.
  /// Letting go starts nothing.
  void Hold(Holder holder, bool held) noexcept {
    const auto bit = static_cast<std::uint8_t>(holder);
    if (held) {
      held_.fetch_or(bit);
    } else {
      held_.fetch_and(static_cast<std::uint8_t>(~bit));
    }
  }
  /// Nothing more is sent to any drive of the bus, not even that the master lives, until a stop or a
  /// commissioning: to measure how the drives stop by themselves.
  void GoSilent() noexcept {
    ++silences_;
    if (Wake* const wake = wake_.load()) wake->Call();
  }
  ServoReport report() const noexcept { return report_.Get(); }
  const std::string& name() const noexcept { return settings_.name; }

  /// Called at every stop, so that the bus thread does not wait for its next cycle; null for nothing.
  /// Outlives the calls.
  void CallOnStop(Wake* wake) noexcept { wake_.store(wake); }

  // From the bus thread.
  /// Takes the newest orders to the master.
  /// @param may_enable  false: the supervision of some drive of the bench is off or unknown, and this one is
  ///   not enabled (docs/requirements.md R15).
  void TakeOrders(std::chrono::nanoseconds now, bool may_enable = true) noexcept;
  void Publish() noexcept;
  protocols::canopen::DriveMaster& master() noexcept { return master_; }
  const CanopenServoSettings& settings() const noexcept { return settings_; }

 private:
  void Leave() noexcept;
  void CommandIn(DriveMode mode, double set_point) noexcept;
  void TryToRaise(std::chrono::nanoseconds now) noexcept;
  void Command() noexcept;
  std::string TroubleWords() const;

  CanopenServoSettings settings_;
  const BenchClock& clock_;

  // Of the control thread.
  ServoOrders orders_;
  mutable std::atomic<std::int64_t> heard_ns_{};

  Latest<ServoOrders> left_;
  std::atomic<Wake*> wake_{};
  std::atomic<std::uint32_t> commissions_{};
  std::atomic<std::uint32_t> silences_{};
  std::atomic<std::uint8_t> held_{};  // bits of `Holder`
  Latest<ServoAnswer> answer_;
  Latest<ServoReport> report_;

  // Of the bus thread.
  protocols::canopen::DriveMaster master_;
  std::array<protocols::OperationMode, 3> modes_{};  // by DriveMode
  ServoOrders taken_;
  std::uint32_t commissions_taken_{};
  std::uint32_t silences_taken_{};
  bool was_held_{};
  bool is_refused_{};  // enabling, for another drive's sake
  bool told_refused_{};
  bool raising_{};
  bool is_loop_silent_{};
  protocols::canopen::DriveTrouble told_first_{};
  protocols::canopen::DriveTrouble told_last_{};
  ServoReport next_report_;
};

}  // namespace strainwave::bench
