// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "protocols/cia402.h"

namespace strainwave::protocols::canopen::device {

/// What the option objects 605Ah and 605Eh choose.
struct StopOptions {
  int quick_stop{2};      // 0 off at once, 1 slow-down ramp, 2 quick-stop ramp; 5 and 6 the same, but stay
  int fault_reaction{2};  // 0 off at once, 1 slow-down ramp, 2 quick-stop ramp
};

/// The drive's side of the power states (CiA 402-2): `NextPowerState` by controlword, and the transitions
/// that a drive makes by itself (0, 1, 12 to 14).
class PowerStage {
 public:
  PowerState state() const { return state_; }
  bool powered() const;

  /// A controlword came, or the last one is looked at again, as a drive does each cycle. Transition 16 is
  /// there only under quick-stop options 5 and 6; the power goes on only while `may_power`, and a fault is
  /// reset only while its cause is gone.
  void OnControlword(std::uint16_t controlword, const StopOptions& options, bool may_power, bool cause_lasts);

  /// Whether this controlword asks to reset a fault that there is.
  bool IsResetBy(std::uint16_t controlword) const;

  /// Transition 13; a drive that does not move has no reaction to make.
  void Fault(const StopOptions& options);
  /// Transition 11 without a controlword, when the connection is lost.
  void QuickStop();
  /// Off at once from any state but the faults, as when safe torque off opens.
  void DisableVoltage();

  /// Once a cycle: transitions 0, 1, 12 and 14. `stopped`: the ramp has come to its end.
  void Step(const StopOptions& options, bool stopped);

  /// The drive stopped by itself since the last call: after a quick stop, at a fault, by `DisableVoltage`.
  bool TakeBrakeRequest();

 private:
  void Go(PowerState next, bool by_itself);

  PowerState state_{PowerState::kNotReadyToSwitchOn};
  std::uint16_t last_controlword_{};
  bool wants_brake_{};
};

}  // namespace strainwave::protocols::canopen::device
