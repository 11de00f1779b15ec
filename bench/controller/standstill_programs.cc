// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/standstill_programs.h"

#include <algorithm>
#include <cmath>

namespace strainwave::bench {
namespace {

constexpr double kReadFor_s = 0.5;

}  // namespace

ReferencingProgram::ReferencingProgram(const Tolerances& tolerances, double ratio, double expected_offset_rad)
    : tolerances_(tolerances), ratio_(ratio), expected_offset_rad_(expected_offset_rad) {}

void ReferencingProgram::SetUp(const Readings&, BenchDevices& devices) {
  devices.driving.Disable();
  devices.load.Disable();
}

StepResult ReferencingProgram::Step(const Readings& readings, double elapsed_s, BenchDevices&) noexcept {
  if (readings.bad_channels != 0) {
    unsigned channel = 0;
    while ((readings.bad_channels & (1u << channel)) == 0) ++channel;
    failed_ = {StopCause::kImplausibleReading, static_cast<double>(channel), 0.0, readings.time};
    return StepResult::kFailedCheck;
  }
  torque_sum_Nm_ += readings.output_torque_Nm;
  ++count_;
  if (elapsed_s < kReadFor_s) return StepResult::kRunning;
  const double torque_Nm = torque_sum_Nm_ / count_;
  if (std::abs(torque_Nm) > tolerances_.torque_zero_Nm) {
    failed_ = {StopCause::kTorqueAtRest, torque_Nm, tolerances_.torque_zero_Nm, readings.time};
    return StepResult::kFailedCheck;
  }
  if (!std::isnan(expected_offset_rad_)) {
    const double offset =
        readings.input_angle_rad / ratio_ - readings.output_angle_rad - expected_offset_rad_;
    if (std::abs(offset) > tolerances_.angle_rad) {
      failed_ = {StopCause::kReferenceCheck, offset, tolerances_.angle_rad, readings.time};
      return StepResult::kFailedCheck;
    }
  }
  return StepResult::kDone;
}

StepResult SoakProgram::Step(const Readings& readings, double elapsed_s, BenchDevices&) noexcept {
  share_done_ = parameters_.at_most_s > 0.0 ? std::min(1.0, elapsed_s / parameters_.at_most_s) : 1.0;
  const bool cool = readings.gear_temperature_degC <= parameters_.below_temperature_degC;
  return cool || elapsed_s >= parameters_.at_most_s ? StepResult::kDone : StepResult::kRunning;
}

}  // namespace strainwave::bench
