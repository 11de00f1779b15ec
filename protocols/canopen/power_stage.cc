// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/power_stage.h"

#include <utility>

namespace strainwave::protocols::canopen::device {
namespace {

bool Stays(const StopOptions& options) { return options.quick_stop >= 5; }

bool IsPowered(PowerState state) {
  return state == PowerState::kOperationEnabled || state == PowerState::kQuickStopActive ||
         state == PowerState::kFaultReactionActive;
}

}  // namespace

bool PowerStage::powered() const { return IsPowered(state_); }

void PowerStage::Go(PowerState next, bool by_itself) {
  const bool stops = powered() && !IsPowered(next);
  if (next == PowerState::kFault || (stops && (by_itself || state_ != PowerState::kOperationEnabled))) {
    wants_brake_ = true;
  }
  state_ = next;
}

bool PowerStage::TakeBrakeRequest() { return std::exchange(wants_brake_, false); }

void PowerStage::OnControlword(std::uint16_t controlword, const StopOptions& options, bool may_power,
                               bool cause_lasts) {
  const PowerState next = NextPowerState(state_, last_controlword_, controlword);
  last_controlword_ = controlword;
  if (state_ == PowerState::kFault && cause_lasts) return;
  if (state_ == PowerState::kQuickStopActive && next == PowerState::kOperationEnabled && !Stays(options))
    return;
  const bool powers_up = next == PowerState::kReadyToSwitchOn || next == PowerState::kSwitchedOn ||
                         next == PowerState::kOperationEnabled;
  if (powers_up && !may_power) return;
  Go(next, false);
}

bool PowerStage::IsResetBy(std::uint16_t controlword) const {
  return state_ == PowerState::kFault && NextPowerState(state_, last_controlword_, controlword) != state_;
}

void PowerStage::Fault(const StopOptions& options) {
  if (state_ == PowerState::kFault || state_ == PowerState::kFaultReactionActive) return;
  const bool reacts = powered() && options.fault_reaction != 0;
  Go(reacts ? PowerState::kFaultReactionActive : PowerState::kFault, true);
}

void PowerStage::QuickStop() {
  if (state_ == PowerState::kOperationEnabled) Go(PowerState::kQuickStopActive, true);
}

void PowerStage::DisableVoltage() {
  if (state_ == PowerState::kFaultReactionActive) Go(PowerState::kFault, true);
  if (state_ != PowerState::kFault && state_ != PowerState::kNotReadyToSwitchOn) {
    Go(PowerState::kSwitchOnDisabled, true);
  }
}

void PowerStage::Step(const StopOptions& options, bool stopped) {
  switch (state_) {
    case PowerState::kNotReadyToSwitchOn:
      Go(PowerState::kSwitchOnDisabled, true);
      break;
    case PowerState::kQuickStopActive:
      if (options.quick_stop == 0 || (stopped && !Stays(options))) Go(PowerState::kSwitchOnDisabled, true);
      break;
    case PowerState::kFaultReactionActive:
      if (stopped || options.fault_reaction == 0) Go(PowerState::kFault, true);
      break;
    case PowerState::kSwitchOnDisabled:
    case PowerState::kReadyToSwitchOn:
    case PowerState::kSwitchedOn:
    case PowerState::kOperationEnabled:
    case PowerState::kFault:
      break;
  }
}

}  // namespace strainwave::protocols::canopen::device
