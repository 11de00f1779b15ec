// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/drive_motion.h"

#include <algorithm>
#include <cmath>

namespace strainwave::protocols::canopen::device {
namespace {

// Bits of the controlword and the statusword that are the mode's (CiA 402-2, Tables 30 and on).
constexpr int kStart = 4;  // new set point; homing starts
constexpr int kAtOnce = 5;
constexpr int kRelative = 6;
constexpr int kHalt = 8;
constexpr int kTargetReached = 10;
constexpr int kLimitActive = 11;
constexpr int kModeBit = 12;  // set point acknowledged; speed is zero; homing attained; the drive follows
constexpr int kFollowingError = 13;
constexpr std::int64_t kNoWindow = 0xFFFFFFFF;  // of 6065h: not supervised

// A stop whose ramp has ended and whose motor still turns ends all the same after this.
constexpr double kMostCoasting_s = 0.5;

double Number(const Object& object) { return static_cast<double>(object.integer()); }

double Towards(double value, double target, double most_change) {
  return value + std::clamp(target - value, -most_change, most_change);
}

// The place that a target of 32 bits means: of all that it could, the nearest.
double NearestTo(double from, std::int64_t wrapped_target) {
  const auto whole = static_cast<std::int64_t>(std::llround(from));
  const auto way = static_cast<std::int32_t>(static_cast<std::uint32_t>(wrapped_target - whole));
  return static_cast<double>(whole + way);
}

}  // namespace

double DriveMotion::Units(double inc) const { return inc / objects_.inc_per_unit(); }
bool DriveMotion::ControlBit(int bit) const { return (objects_.controlword.integer() >> bit & 1) != 0; }
void DriveMotion::SetStatus(int bit, bool set) {
  if (set) status_bits_ = static_cast<std::uint16_t>(status_bits_ | 1U << bit);
}

double DriveMotion::Clamp(double value, double most) {
  SetStatus(kLimitActive, std::abs(value) > most);
  return std::clamp(value, -most, most);
}

bool DriveMotion::HeldFor(double& held_s, double dt_s, bool condition, const Object& time_ms) {
  held_s = condition ? held_s + dt_s : 0.0;
  return condition && held_s * 1000.0 >= Number(time_ms);
}

void DriveMotion::Report(const DriveReading& reading) {
  actual_position_ = Units(reading.position_inc) - home_;
  actual_speed_ = Units(reading.speed_inc_per_s);
  objects_.position_actual.Set(std::llround(actual_position_));
  objects_.speed_actual.Set(std::llround(actual_speed_));
  objects_.torque_actual.Set(std::llround(reading.torque_permille));
}

void DriveMotion::CountFrom(double position) {
  const double further = position - actual_position_;
  home_ -= further;
  for (double* const place : {&actual_position_, &position_, &target_, &next_target_}) *place += further;
  objects_.position_actual.Set(std::llround(actual_position_));
}

// Set points begin where the motor is.
void DriveMotion::Begin(const DriveReading& reading) {
  position_ = target_ = actual_position_;
  speed_ = actual_speed_;
  torque_ = reading.torque_permille;
  has_next_ = false;
  cyclic_target_.reset();
  start_bit_ = ControlBit(kStart);
  in_window_s_ = outside_s_ = 0.0;
}

DriveCommand DriveMotion::HoldSpeed() const {
  DriveCommand command;
  command.loop = DriveLoop::kSpeed;
  command.speed_inc_per_s = speed_ * objects_.inc_per_unit();
  return command;
}

DriveCommand DriveMotion::HoldPosition() const {
  DriveCommand command;
  command.loop = DriveLoop::kPosition;
  command.position_inc = (position_ + home_) * objects_.inc_per_unit();
  command.speed_inc_per_s = speed_ * objects_.inc_per_unit();
  return command;
}

DriveCommand DriveMotion::Step(double dt_s, PowerState state, DriveMode mode, const StopOptions& options,
                               const DriveReading& reading) {
  Report(reading);
  status_bits_ = 0;
  following_error_ = false;
  DriveCommand command;
  const bool halts = state == PowerState::kOperationEnabled && ControlBit(kHalt);
  const bool stops =
      halts || state == PowerState::kQuickStopActive || state == PowerState::kFaultReactionActive;
  if (mode != mode_) running_ = false;
  mode_ = mode;
  if (stops) {
    int option = options.quick_stop;
    if (halts) option = static_cast<int>(objects_.halt_option.integer());
    if (state == PowerState::kFaultReactionActive) option = options.fault_reaction;
    command = Stop(dt_s, option == 2 || option == 6 ? Ramp::kQuickStop : Ramp::kSlowDown, reading);
    SetStatus(kTargetReached, stopped_);
    running_ = false;
  } else if (state == PowerState::kOperationEnabled) {
    if (!running_) Begin(reading);
    running_ = true;
    stopping_ = stopped_ = false;
    command = Run(dt_s, mode);
  } else {
    Begin(reading);
    torque_ = 0.0;
    running_ = stopping_ = false;
    stopped_ = true;
  }
  command.torque_limit_permille = Number(objects_.torque_limit);
  objects_.position_demand.Set(std::llround(position_));
  objects_.speed_demand.Set(std::llround(speed_));
  objects_.torque_demand.Set(std::llround(torque_));
  return command;
}

DriveCommand DriveMotion::Stop(double dt_s, Ramp ramp, const DriveReading& reading) {
  if (!stopping_) {
    speed_ = actual_speed_;
    if (!running_) torque_ = reading.torque_permille;
    stopping_s_ = 0.0;
  }
  stopping_ = true;
  position_ = target_ = actual_position_;
  has_next_ = false;
  const bool has_speed_loop =
      objects_.Supports(DriveMode::kProfileVelocity) || objects_.Supports(DriveMode::kCyclicVelocity);
  if (!has_speed_loop) {
    torque_ = Towards(torque_, 0.0, Number(objects_.torque_slope) * dt_s);
    stopped_ = torque_ == 0.0;
    DriveCommand command;
    command.loop = DriveLoop::kTorque;
    command.torque_permille = torque_;
    return command;
  }
  const Object& rate = ramp == Ramp::kQuickStop ? objects_.quick_stop_deceleration : objects_.deceleration;
  speed_ = Towards(speed_, 0.0, Number(rate) * dt_s);
  if (speed_ == 0.0) stopping_s_ += dt_s;
  const bool stands = std::abs(actual_speed_) <= Number(objects_.standstill_speed);
  stopped_ = speed_ == 0.0 && (stands || stopping_s_ > kMostCoasting_s);
  return HoldSpeed();
}

DriveCommand DriveMotion::Run(double dt_s, DriveMode mode) {
  switch (mode) {
    case DriveMode::kProfilePosition:
      return ProfilePosition(dt_s);
    case DriveMode::kProfileVelocity:
      return ProfileVelocity(dt_s);
    case DriveMode::kTorque:
      return Torque(dt_s, false);
    case DriveMode::kHoming:
      return Home();
    case DriveMode::kCyclicPosition:
      return CyclicPosition(dt_s);
    case DriveMode::kCyclicVelocity:
      return CyclicVelocity(dt_s);
    case DriveMode::kCyclicTorque:
      return Torque(dt_s, true);
    case DriveMode::kNone:
      break;
  }
  // Powered without a mode: no torque.
  torque_ = 0.0;
  DriveCommand command;
  command.loop = DriveLoop::kTorque;
  return command;
}

// Bit 4 rising offers a set point, bit 12 takes it, bit 4 falling gives bit 12 back. One more can wait.
void DriveMotion::TakeSetPoints() {
  const bool start = ControlBit(kStart);
  if (start && !start_bit_ && !has_next_) {
    const double value = ControlBit(kRelative) ? target_ + Number(objects_.target_position)
                                               : NearestTo(position_, objects_.target_position.integer());
    const bool moving = position_ != target_;
    if (moving && !ControlBit(kAtOnce)) {
      next_target_ = value;
      has_next_ = true;
    } else {
      target_ = value;
    }
    in_window_s_ = 0.0;
  }
  start_bit_ = start;
  SetStatus(kModeBit, start || has_next_);
}

DriveCommand DriveMotion::ProfilePosition(double dt_s) {
  TakeSetPoints();
  if (position_ == target_ && has_next_) {
    target_ = next_target_;
    has_next_ = false;
  }
  const double most = Clamp(Number(objects_.profile_speed), objects_.speed_limit());
  const double way = target_ - position_;
  const double braking = Number(objects_.deceleration);
  const double wanted = std::copysign(std::min(most, std::sqrt(2.0 * braking * std::abs(way))), way);
  const bool faster = std::abs(wanted) > std::abs(speed_) && wanted * speed_ >= 0.0;
  speed_ = Towards(speed_, wanted, (faster ? Number(objects_.acceleration) : braking) * dt_s);
  const double step = speed_ * dt_s;
  if (std::abs(way) <= std::abs(step) + 0.5 && step * way >= 0.0) {
    position_ = target_;
    speed_ = 0.0;
  } else {
    position_ += step;
  }
  SupervisePosition(dt_s, position_ == target_ && !has_next_);
  return HoldPosition();
}

void DriveMotion::SupervisePosition(double dt_s, bool final) {
  const double error = position_ - actual_position_;
  objects_.following_error.Set(std::llround(error));
  const bool in_window = final && std::abs(error) <= Number(objects_.position_window);
  if (HeldFor(in_window_s_, dt_s, in_window, objects_.position_time)) SetStatus(kTargetReached, true);
  const bool supervised = objects_.following_window.integer() != kNoWindow;
  const bool outside = supervised && std::abs(error) > Number(objects_.following_window);
  following_error_ = HeldFor(outside_s_, dt_s, outside, objects_.following_time);
  SetStatus(kFollowingError, following_error_);
}

DriveCommand DriveMotion::ProfileVelocity(double dt_s) {
  const double target = Clamp(Number(objects_.target_speed), objects_.speed_limit());
  const bool faster = std::abs(target) > std::abs(speed_) && target * speed_ >= 0.0;
  speed_ = Towards(speed_, target, Number(faster ? objects_.acceleration : objects_.deceleration) * dt_s);
  const bool in_window = std::abs(target - actual_speed_) <= Number(objects_.speed_window);
  if (HeldFor(in_window_s_, dt_s, in_window, objects_.speed_time)) SetStatus(kTargetReached, true);
  SetStatus(kModeBit, std::abs(actual_speed_) <= Number(objects_.standstill_speed));
  return HoldSpeed();
}

DriveCommand DriveMotion::Torque(double dt_s, bool cyclic) {
  const double target = Clamp(Number(objects_.target_torque), Number(objects_.torque_limit));
  torque_ = cyclic ? Interpolated(torque_, target, dt_s)
                   : Towards(torque_, target, Number(objects_.torque_slope) * dt_s);
  const bool too_fast = std::abs(actual_speed_) > objects_.speed_limit() && torque_ * actual_speed_ > 0.0;
  if (too_fast) torque_ = 0.0;
  SetStatus(kLimitActive, too_fast);
  if (cyclic) {
    SetStatus(kModeBit, true);
  } else {
    SetStatus(kTargetReached, torque_ == target);
  }
  DriveCommand command;
  command.loop = DriveLoop::kTorque;
  command.torque_permille = torque_;
  return command;
}

DriveCommand DriveMotion::Home() {
  const bool start = ControlBit(kStart);
  if (start && !start_bit_) {
    CountFrom(Number(objects_.home_offset));
    position_ = target_ = actual_position_;
    homed_ = true;
  }
  start_bit_ = start;
  speed_ = 0.0;
  SetStatus(kTargetReached, true);
  SetStatus(kModeBit, homed_);
  return HoldPosition();
}

// The set point after another `dt_s` on its way from where it is to the target of a cyclic mode.
double DriveMotion::Interpolated(double from, double target, double dt_s) {
  constexpr double kRounding = 1e-6;
  if (cyclic_target_ != target) to_cyclic_target_s_ = objects_.interpolation_s();
  cyclic_target_ = target;
  const bool arrives = dt_s >= to_cyclic_target_s_ * (1.0 - kRounding);
  const double value = arrives ? target : from + (target - from) * dt_s / to_cyclic_target_s_;
  to_cyclic_target_s_ = arrives ? 0.0 : to_cyclic_target_s_ - dt_s;
  return value;
}

DriveCommand DriveMotion::CyclicPosition(double dt_s) {
  const double target = NearestTo(position_, objects_.target_position.integer());
  const double way = Clamp(Interpolated(position_, target, dt_s) - position_, objects_.speed_limit() * dt_s);
  position_ += way;
  speed_ = dt_s > 0.0 ? way / dt_s : 0.0;
  SetStatus(kModeBit, true);
  SupervisePosition(dt_s, false);
  return HoldPosition();
}

DriveCommand DriveMotion::CyclicVelocity(double dt_s) {
  speed_ = Interpolated(speed_, Clamp(Number(objects_.target_speed), objects_.speed_limit()), dt_s);
  SetStatus(kModeBit, true);
  return HoldSpeed();
}

}  // namespace strainwave::protocols::canopen::device
