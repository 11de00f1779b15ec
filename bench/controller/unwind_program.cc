// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/unwind_program.h"

#include <cmath>

#include "analysis/units.h"

namespace strainwave::bench {
namespace {

// What a rotor swings against the gear's stiffness has died away after some 0.1 s.
constexpr double kSmallFor_s = 0.3;
constexpr double kLongest_s = 3.0;
constexpr double kShareOfZero = 0.5;
// Wind-up at peak torque is below 0.3 deg, dead stroke below 0.1 deg. What turns further is driven.
constexpr double kFurthest_rad = RadFromDeg(2.0);

}  // namespace

void UnwindProgram::SetUp(const Readings& readings, BenchDevices& devices) {
  start_output_rad_ = readings.output_angle_rad;
  devices.driving.Disable();
  devices.load.Enable(DriveMode::kTorque);
}

StepResult UnwindProgram::Step(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept {
  if (std::abs(readings.output_angle_rad - start_output_rad_) > kFurthest_rad) {
    failed_ = {StopCause::kReferenceCheck, readings.output_angle_rad - start_output_rad_, kFurthest_rad,
               readings.time, BenchServo::kLoad};
    return StepResult::kFailedCheck;
  }
  if (released_s_ < 0.0) {
    if (!BroughtUp(devices.load)) return StepResult::kRunning;
    released_s_ = small_since_s_ = elapsed_s;
  }
  devices.load.CommandTorque(0.0);
  if (std::abs(readings.output_torque_Nm) > kShareOfZero * torque_zero_Nm_) small_since_s_ = elapsed_s;
  const bool small = elapsed_s - small_since_s_ >= kSmallFor_s;
  return small || elapsed_s - released_s_ >= kLongest_s ? StepResult::kDone : StepResult::kRunning;
}

}  // namespace strainwave::bench
