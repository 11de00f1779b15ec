// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/canopen/canopen_servo.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace strainwave::bench {

using protocols::OperationMode;
using protocols::canopen::DriveAnswer;
using protocols::canopen::DriveStage;
using protocols::canopen::DriveStatus;
using protocols::canopen::DriveTrouble;
using std::chrono::nanoseconds;

namespace {

// Cyclic modes where the drive has them: the set-point then comes from the bench every SYNC.
OperationMode ModeFor(const CanopenServoSettings& settings, std::string_view what,
                      std::initializer_list<OperationMode> wanted) {
  for (const OperationMode mode : wanted) {
    if (std::ranges::find(settings.profile.modes, mode) != settings.profile.modes.end()) return mode;
  }
  throw std::invalid_argument(fmt::format("modes of profile '{}' have none for {} (the {} needs one)",
                                          settings.profile.name, what, settings.name));
}

bool IsOnTheWayUp(DriveStage stage) {
  return stage == DriveStage::kChangingMode || stage == DriveStage::kRaising || stage == DriveStage::kEnabled;
}

}  // namespace

CanopenServo::CanopenServo(CanopenServoSettings settings, const BenchClock& clock)
    : settings_(std::move(settings)), clock_(clock), master_(settings_.profile, settings_.node_id) {
  modes_ = {ModeFor(settings_, "speed", {OperationMode::kCyclicVelocity, OperationMode::kProfileVelocity}),
            ModeFor(settings_, "position", {OperationMode::kCyclicPosition, OperationMode::kProfilePosition}),
            ModeFor(settings_, "torque", {OperationMode::kCyclicTorque, OperationMode::kProfileTorque})};
  static_assert(static_cast<int>(DriveMode::kSpeed) == 0 && static_cast<int>(DriveMode::kPosition) == 1 &&
                static_cast<int>(DriveMode::kTorque) == 2);
  Publish();
}

void CanopenServo::Leave() noexcept {
  heard_ns_.store(clock_.Now().count(), std::memory_order_relaxed);
  left_.Set(orders_);
}

void CanopenServo::Enable(DriveMode mode) noexcept {
  ++orders_.raisings;
  orders_.raise = true;
  orders_.mode = mode;
  orders_.has_set_point = false;
  Leave();
}

void CanopenServo::Disable() noexcept {
  ++orders_.lowerings;
  orders_.raise = false;
  orders_.has_set_point = false;
  Leave();
}

void CanopenServo::QuickStop() noexcept {
  ++orders_.stops;
  orders_.raise = false;
  orders_.has_set_point = false;
  orders_.brake_engaged = true;
  Leave();
  if (Wake* const wake = wake_.load()) wake->Call();
}

void CanopenServo::ResetFault() noexcept {
  ++orders_.resets;
  Leave();
}

void CanopenServo::SetBrake(bool engaged) noexcept {
  orders_.brake_engaged = engaged;
  Leave();
}

void CanopenServo::CommandIn(DriveMode mode, double set_point) noexcept {
  if (!orders_.raise || orders_.mode != mode) return;
  orders_.has_set_point = true;
  orders_.set_point = set_point;
  Leave();
}

void CanopenServo::CommandSpeed(double speed_rad_per_s) noexcept {
  CommandIn(DriveMode::kSpeed, speed_rad_per_s);
}
void CanopenServo::CommandPosition(double position_rad) noexcept {
  CommandIn(DriveMode::kPosition, position_rad);
}
void CanopenServo::CommandTorque(double torque_Nm) noexcept { CommandIn(DriveMode::kTorque, torque_Nm); }

DriveActual CanopenServo::Actual() const noexcept {
  heard_ns_.store(clock_.Now().count(), std::memory_order_relaxed);
  const ServoAnswer answer = answer_.Get();
  DriveActual actual = answer.actual;
  // In another mode, perhaps, or about to stop: of the newest order to enable it says nothing.
  const bool is_older = orders_.raise && answer.raisings != orders_.raisings;
  if (is_older && actual.power == protocols::PowerState::kOperationEnabled) {
    actual.power = protocols::PowerState::kSwitchedOn;
  }
  return actual;
}

void CanopenServo::TakeOrders(nanoseconds now, bool may_enable) noexcept {
  const ServoOrders orders = left_.Get();
  const bool held = held_.load() != 0;
  const bool silent =
      IsOnTheWayUp(master_.stage()) &&
      now - nanoseconds(heard_ns_.load(std::memory_order_relaxed)) > settings_.longest_silence;
  if (orders.stops != taken_.stops || (held && !was_held_) || silent) {
    raising_ = false;
    is_loop_silent_ = silent;
    master_.QuickStop(now);
  }
  was_held_ = held;
  if (const std::uint32_t commissions = commissions_.load(); commissions != commissions_taken_) {
    commissions_taken_ = commissions;
    is_loop_silent_ = is_refused_ = false;
    (void)master_.Commission(now);
  }
  if (orders.lowerings != taken_.lowerings) {
    raising_ = false;
    master_.Disable(now);
  }
  if (orders.resets != taken_.resets) {
    is_loop_silent_ = false;
    (void)master_.ResetFault(now);
  }
  if (const std::uint32_t silences = silences_.load(); silences != silences_taken_) {
    silences_taken_ = silences;
    raising_ = false;
    master_.GoSilent();
  }
  if (orders.raisings != taken_.raisings) {
    raising_ = orders.raise && !silent && may_enable;
    is_refused_ = orders.raise && !may_enable;
  }
  taken_ = orders;
  if (held || !may_enable) raising_ = false;
  if (raising_) TryToRaise(now);
  (void)master_.SetBrake(orders.brake_engaged || !orders.raise || held);
  if (master_.stage() == DriveStage::kEnabled && orders.raise && orders.has_set_point) Command();
}

void CanopenServo::TryToRaise(nanoseconds now) noexcept {
  const bool stopped_by_bench = master_.trouble() == DriveTrouble::kQuickStopAsked &&
                                master_.last_trouble() == DriveTrouble::kQuickStopAsked && !is_loop_silent_;
  switch (master_.Enable(modes_[static_cast<std::size_t>(taken_.mode)], now)) {
    case DriveAnswer::kResetFirst:
      if (stopped_by_bench) {
        (void)master_.ResetFault(now);
      } else {
        raising_ = false;
      }
      return;
    case DriveAnswer::kStillStopping:
    case DriveAnswer::kStatusStale:
      return;  // asked again in the next cycle; the phase gives up after its own time
    case DriveAnswer::kAccepted:
    case DriveAnswer::kCommissionFirst:
    case DriveAnswer::kDriveInFault:
    case DriveAnswer::kModeNotInProfile:
    case DriveAnswer::kDisableFirst:
    case DriveAnswer::kNotEnabledInMode:
    case DriveAnswer::kNotANumber:
      raising_ = false;
      return;
  }
}

void CanopenServo::Command() noexcept {
  switch (taken_.mode) {
    case DriveMode::kSpeed:
      (void)master_.CommandSpeed(taken_.set_point);
      return;
    case DriveMode::kPosition:
      (void)master_.CommandPosition(taken_.set_point);
      return;
    case DriveMode::kTorque:
      (void)master_.CommandTorque(taken_.set_point);
      return;
  }
}

std::string CanopenServo::TroubleWords() const {
  if (is_loop_silent_) return "the control loop gave no sign of life";
  if (is_refused_) {
    return "not enabled: the supervision of a drive of this bench is off or unknown, so that it would not "
           "notice that this program is gone";
  }
  // A stop that the bench itself asked for is no trouble, neither alone nor behind one.
  const auto is_trouble = [](DriveTrouble trouble) {
    return trouble != DriveTrouble::kNone && trouble != DriveTrouble::kQuickStopAsked;
  };
  const bool also_last = is_trouble(told_last_) && told_last_ != told_first_;
  if (!is_trouble(told_first_)) {
    return also_last ? std::string(protocols::canopen::Words(told_last_)) : std::string();
  }
  std::string words = master_.TroubleWords();
  if (also_last) words += fmt::format("; then {}", protocols::canopen::Words(told_last_));
  return words;
}

void CanopenServo::Publish() noexcept {
  const DriveStatus& status = master_.status();
  const DriveTrouble trouble = master_.trouble();
  const bool in_trouble = is_loop_silent_ ||
                          (trouble != DriveTrouble::kNone && trouble != DriveTrouble::kQuickStopAsked) ||
                          (master_.last_trouble() != DriveTrouble::kNone &&
                           master_.last_trouble() != DriveTrouble::kQuickStopAsked);
  DriveActual actual;
  actual.time = status.time;
  actual.position_rad = status.position_rad;
  actual.speed_rad_per_s = status.speed_rad_per_s;
  actual.torque_Nm = status.torque_Nm;
  actual.power = in_trouble ? protocols::PowerState::kFault
                            : status.power.value_or(protocols::PowerState::kNotReadyToSwitchOn);
  // Enabled is for the bench who follows its set-points, not who merely says so; in a silence nobody follows
  // any, and what the drive makes of it is what is looked at.
  if (actual.power == protocols::PowerState::kOperationEnabled && master_.stage() != DriveStage::kEnabled &&
      master_.stage() != DriveStage::kSilent) {
    actual.power = protocols::PowerState::kSwitchedOn;
  }
  actual.brake_engaged = status.is_brake_engaged;
  answer_.Set({actual, taken_.raisings});

  ServoReport& report = next_report_;
  report.stage = master_.stage();
  report.trouble = trouble;
  report.commissions = commissions_taken_;
  report.steps_done = static_cast<std::uint32_t>(master_.commissioning().steps_done());
  report.steps = static_cast<std::uint32_t>(master_.commissioning().steps().size());
  report.heard = !status.is_stale;
  report.brake_engaged = status.is_brake_engaged;
  report.torque_off_known = status.is_torque_safely_off.has_value();
  report.torque_safely_off = status.is_torque_safely_off.value_or(false);
  report.supervised = master_.is_supervised();
  if (trouble != told_first_ || master_.last_trouble() != told_last_ || is_refused_ != told_refused_) {
    told_refused_ = is_refused_;
    told_first_ = trouble;
    told_last_ = master_.last_trouble();
    const std::string words = TroubleWords();  // takes memory; the stop is out by now
    report.words.fill('\0');
    std::copy_n(words.begin(), std::min(words.size(), report.words.size() - 1), report.words.begin());
  }
  report_.Set(report);
}

}  // namespace strainwave::bench
