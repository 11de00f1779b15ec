// SPDX-License-Identifier: Apache-2.0
#include "bench/trip_test/provoked_program.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/units.h"
#include "bench/controller/make_program.h"

namespace strainwave::bench {
namespace {

constexpr double kMostSpeed_rad_per_s = RadPerSFromRpm(300.0);
constexpr double kShareOfSpeedLimit = 1.0 / 3.0;
constexpr double kShareOfRatedTorque = 0.25;
constexpr double kShareOfTorqueLimit = 0.5;
constexpr double kAcceleration_rad_per_s2 = 100.0;
constexpr double kTorqueRate_Nm_per_s = 20.0;
constexpr double kLockRate_Nm_per_s = 2.0;
constexpr double kForEver_s = 3600.0;  // the condition, or the wait for it, is what ends the phase
// Ramps are over, set points have settled; the lock test has some torque on.
constexpr double kSteady_s = 1.5;
constexpr double kLockedFor_s = 2.5;

double Torque_Nm(const TripSettings& settings) {
  return std::min(kShareOfRatedTorque * settings.specimen.rated_torque_Nm,
                  kShareOfTorqueLimit * settings.limits.output_torque_Nm);
}

schedules::PhaseParameters PhaseOf(TripMotion motion, const TripSettings& settings) {
  switch (motion) {
    case TripMotion::kStandstill: {
      // Nothing is as cold as this: it waits.
      schedules::Soak soak;
      soak.below_temperature_degC = -300.0;
      soak.at_most_s = kForEver_s;
      return soak;
    }
    case TripMotion::kComingUp:
    case TripMotion::kTurning: {
      schedules::LoadRun run;
      run.duration_s = kForEver_s;
      run.output_torque_Nm = Torque_Nm(settings);
      run.input_speed_rad_per_s =
          std::min(kMostSpeed_rad_per_s, kShareOfSpeedLimit * settings.limits.input_speed_rad_per_s);
      run.input_acceleration_rad_per_s2 = kAcceleration_rad_per_s2;
      run.torque_rate_Nm_per_s = kTorqueRate_Nm_per_s;
      run.tolerances = settings.tolerances;
      return run;
    }
    case TripMotion::kLocked: {
      schedules::HysteresisTest test;
      test.peak_torque_Nm = Torque_Nm(settings);
      test.torque_rate_Nm_per_s = kLockRate_Nm_per_s;
      test.hold_s = kForEver_s;
      test.log_rate_hz = 1.0;
      test.lock_angles_rad = {0.0};
      return test;
    }
  }
  return {};
}

bool IsUp(const DriveActual& drive) {
  return drive.power == protocols::PowerState::kOperationEnabled && !drive.brake_engaged;
}

}  // namespace

std::unique_ptr<PhaseProgram> MakeMotion(TripMotion motion, const TripSettings& settings, double period_s) {
  return MakeProgram(PhaseOf(motion, settings), settings.specimen, 0.0, period_s);
}

ProvokedProgram::ProvokedProgram(std::unique_ptr<PhaseProgram> phase, TripMotion motion, double wait_s,
                                 std::function<void(const ProvokedState&)> provoke)
    : phase_(std::move(phase)), motion_(motion), wait_s_(wait_s), provoke_(std::move(provoke)) {}

void ProvokedProgram::SetUp(const Readings& readings, BenchDevices& devices) {
  if (motion_ == TripMotion::kComingUp) ProvokeNow(readings, 0.0);
  phase_->SetUp(readings, devices);
}

bool ProvokedProgram::IsSteady(const BenchDevices& devices) const noexcept {
  switch (motion_) {
    case TripMotion::kStandstill:
    case TripMotion::kComingUp:
      return true;
    case TripMotion::kTurning:
      return IsUp(devices.driving.Actual()) && IsUp(devices.load.Actual());
    case TripMotion::kLocked:
      return phase_->input_locked();
  }
  return false;
}

void ProvokedProgram::ProvokeNow(const Readings& readings, double elapsed_s) {
  provoked_at_s_ = elapsed_s;
  const double twist_rad =
      phase_->input_locked() ? readings.output_angle_rad - phase_->locked_output_angle_rad() : 0.0;
  provoke_({readings, twist_rad});
}

StepResult ProvokedProgram::Step(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept {
  const StepResult result = phase_->Step(readings, elapsed_s, devices);
  if (provoked_at_s_) return elapsed_s - *provoked_at_s_ > wait_s_ ? StepResult::kDone : result;
  if (!IsSteady(devices)) {
    steady_since_s_ = std::nullopt;
    return result;
  }
  if (!steady_since_s_) steady_since_s_ = elapsed_s;
  const double needed_s = motion_ == TripMotion::kLocked ? kLockedFor_s : kSteady_s;
  if (elapsed_s - *steady_since_s_ >= needed_s) ProvokeNow(readings, elapsed_s);
  return result;
}

}  // namespace strainwave::bench
