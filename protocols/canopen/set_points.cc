// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/set_points.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "analysis/units.h"

namespace strainwave::protocols::canopen {
namespace {

constexpr std::int64_t kHalfOfTheNumbers = std::int64_t{1} << 31;

}  // namespace

SetPoints::SetPoints(const DriveProfile& profile) : units_(profile.units), limits_(profile.limits) {}

void SetPoints::Hold(const DriveInputs& inputs, DriveOutputs& outputs) noexcept {
  speed_rad_per_s_ = 0.0;
  torque_Nm_ = 0.0;
  position_counts_.reset();
  homing_asked_ = homing_runs_ = false;
  led_speed_rad_per_s_ = 0.0;
  led_position_counts_ = static_cast<double>(inputs.position);
  handshake_ = Handshake::kIdle;
  outputs.target_position = inputs.position;
  outputs.target_velocity = 0;
  outputs.target_torque = 0;
}

bool SetPoints::AskSpeed(double speed_rad_per_s) noexcept {
  if (!std::isfinite(speed_rad_per_s)) return false;
  speed_rad_per_s_ = std::clamp(speed_rad_per_s, -limits_.max_speed_rad_per_s, limits_.max_speed_rad_per_s);
  return true;
}

bool SetPoints::AskTorque(double torque_Nm) noexcept {
  if (!std::isfinite(torque_Nm)) return false;
  torque_Nm_ = std::clamp(torque_Nm, -limits_.max_torque_Nm, limits_.max_torque_Nm);
  return true;
}

bool SetPoints::AskPosition(double position_rad, const DriveInputs& inputs) noexcept {
  const std::optional<std::int64_t> counts = PositionCounts(units_, position_rad);
  if (!counts || std::abs(*counts - inputs.position) >= kHalfOfTheNumbers) return false;
  position_counts_ = counts;
  return true;
}

void SetPoints::AskHoming() noexcept {
  homing_asked_ = true;
  homing_runs_ = false;
}

void SetPoints::Step(OperationMode mode, std::uint16_t statusword, std::chrono::nanoseconds elapsed,
                     DriveOutputs& outputs) noexcept {
  const double elapsed_s = std::chrono::duration<double>(elapsed).count();
  const StatusBits bits = StatusBitsOf(mode, statusword);
  switch (mode) {
    case OperationMode::kProfilePosition:
      StepProfilePosition(bits, outputs);
      break;
    case OperationMode::kCyclicPosition:
      StepCyclicPosition(elapsed_s, outputs);
      break;
    case OperationMode::kProfileVelocity:
      outputs.target_velocity = VelocityUnits(units_, speed_rad_per_s_).value_or(0);
      break;
    case OperationMode::kCyclicVelocity:
      StepCyclicSpeed(elapsed_s, outputs);
      break;
    case OperationMode::kProfileTorque:
    case OperationMode::kCyclicTorque:
      outputs.target_torque = TorquePerMille(units_, torque_Nm_).value_or(0);
      break;
    case OperationMode::kHoming:
      // Lowered before it has attained, the bit would break the homing off; lowered after, it allows another.
      homing_runs_ = homing_asked_ && (homing_runs_ || !bits.homing_attained);
      if (homing_runs_ && bits.homing_attained) homing_asked_ = homing_runs_ = false;
      if (homing_asked_) outputs.controlword |= kControlwordHomingStart;
      break;
    case OperationMode::kNone:
    case OperationMode::kVelocity:
    case OperationMode::kInterpolatedPosition:
      break;
  }
}

// Set-point and acknowledge (IEC 61800-7-201): the bit falls once the drive has acknowledged, and may rise
// again once it has taken its acknowledge back. It rises one SYNC after the new target went out, as a
// controlword that acts at once would overtake a target that waits for SYNC, and start a move to the old one.
void SetPoints::StepProfilePosition(const StatusBits& bits, DriveOutputs& outputs) noexcept {
  switch (handshake_) {
    case Handshake::kIdle:
      if (position_counts_ && !bits.set_point_acknowledged) {
        outputs.target_position = *position_counts_;
        position_counts_.reset();
        handshake_ = Handshake::kPlaced;
      }
      break;
    case Handshake::kPlaced:
      handshake_ = Handshake::kRaised;
      break;
    case Handshake::kRaised:
      if (bits.set_point_acknowledged) handshake_ = Handshake::kLowered;
      break;
    case Handshake::kLowered:
      if (!bits.set_point_acknowledged) handshake_ = Handshake::kIdle;
      break;
  }
  outputs.controlword |= kControlwordChangeAtOnce;
  if (handshake_ == Handshake::kRaised) outputs.controlword |= kControlwordNewSetPoint;
}

void SetPoints::StepCyclicPosition(double elapsed_s, DriveOutputs& outputs) noexcept {
  if (!position_counts_) return;
  const double most =
      limits_.max_speed_rad_per_s * elapsed_s * units_.position_counts_per_rev * units_.gear_ratio / kTwoPi;
  const double way = static_cast<double>(*position_counts_) - led_position_counts_;
  led_position_counts_ += std::clamp(way, -most, most);
  outputs.target_position = std::llround(led_position_counts_);
}

void SetPoints::StepCyclicSpeed(double elapsed_s, DriveOutputs& outputs) noexcept {
  const double most = limits_.acceleration_rad_per_s2 * elapsed_s;
  led_speed_rad_per_s_ += std::clamp(speed_rad_per_s_ - led_speed_rad_per_s_, -most, most);
  outputs.target_velocity = VelocityUnits(units_, led_speed_rad_per_s_).value_or(0);
}

}  // namespace strainwave::protocols::canopen
