// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/jog_program.h"

#include <limits>
#include <utility>

namespace strainwave::bench {

JogProgram::JogProgram(const JogParameters& parameters,
                       std::function<bool(std::chrono::nanoseconds now)> held)
    : parameters_(parameters), held_(std::move(held)), speed_(parameters.acceleration_rad_per_s2) {}

double JogProgram::timeout_s() const { return std::numeric_limits<double>::infinity(); }

StepResult JogProgram::Step(const Readings&, double, BenchDevices& devices) noexcept {
  const bool turns_driving = parameters_.drive == JogDrive::kDriving;
  ServoDrive& turning = turns_driving ? devices.driving : devices.load;
  ServoDrive& turned = turns_driving ? devices.load : devices.driving;
  if (!held_(devices.clock.Now())) {
    if (!raised_) return StepResult::kRunning;
    turning.QuickStop();
    turned.QuickStop();
    raised_ = false;
    return StepResult::kRunning;
  }
  if (!raised_) {
    turning.Enable(DriveMode::kSpeed);
    turned.Enable(DriveMode::kTorque);
    raised_ = true;
    speed_ = Ramp(parameters_.acceleration_rad_per_s2);
    return StepResult::kRunning;
  }
  // The one that is turned first: nothing pushes against a brake.
  if (!BroughtUp(turned) || !BroughtUp(turning)) return StepResult::kRunning;
  turned.CommandTorque(0.0);
  turning.CommandSpeed(speed_.Step(parameters_.speed_rad_per_s, parameters_.period_s));
  return StepResult::kRunning;
}

}  // namespace strainwave::bench
