// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/load_check_program.h"

#include <algorithm>
#include <cmath>

#include "analysis/units.h"

namespace strainwave::bench {
namespace {

constexpr double kSpeed_rad_per_s = RadPerSFromRpm(60.0);  // of the input
constexpr double kAcceleration_rad_per_s2 = 20.0;
constexpr double kCheckTorqueRate_Nm_per_s = 5.0;
constexpr double kCheckSettle_s = 0.4;  // of the speed; of a torque that has come to stand
constexpr double kAverage_s = 0.4;
constexpr double kReturnGain_per_s = 3.0;
constexpr double kReturned_rad = RadFromDeg(1.0);
// A motor's torque constant and the efficiency of a planetary reducer are within a tenth each; a wrong
// reducer, unit or shaft is a factor of two and more.
constexpr double kLeastTorqueFactor = 0.7;
constexpr double kMostTorqueFactor = 1.3;
constexpr double kSpeedTolerance = 0.1;
// Beyond this much more than asked for the torque goes on rising by the factor that is looked for.
constexpr double kMostCheckOvershoot = 2.0;

}  // namespace

LoadCheckProgram::LoadCheckProgram(const schedules::Specimen& specimen, double period_s)
    : torque_Nm_(0.5 * specimen.t1_Nm),
      period_s_(period_s),
      speed_(kAcceleration_rad_per_s2),
      torque_(kCheckTorqueRate_Nm_per_s) {}

void LoadCheckProgram::SetUp(const Readings& readings, BenchDevices& devices) {
  start_rad_ = readings.input_angle_rad;
  devices.driving.Enable(DriveMode::kSpeed);
  devices.load.Enable(DriveMode::kTorque);
}

// Once a segment of constant set points has settled, its mean; then on to the next one.
StepResult LoadCheckProgram::Hold(const Readings& readings, double elapsed_s, Stage next,
                                  double& mean_Nm) noexcept {
  const double in_stage_s = elapsed_s - stage_start_s_;
  if (in_stage_s < kCheckSettle_s) return StepResult::kRunning;
  sum_Nm_ += readings.output_torque_Nm;
  ++count_;
  if (in_stage_s < kCheckSettle_s + kAverage_s) return StepResult::kRunning;
  mean_Nm = sum_Nm_ / count_;
  sum_Nm_ = 0.0;
  count_ = 0;
  stage_ = next;
  stage_start_s_ = elapsed_s;
  return StepResult::kRunning;
}

bool LoadCheckProgram::Judge(const Readings& readings) noexcept {
  torque_factor_ = (positive_Nm_ - negative_Nm_) / (2.0 * torque_Nm_);
  speed_factor_ = (readings.input_angle_rad - turned_from_rad_) / asked_rad_;
  if (!(std::abs(speed_factor_ - 1.0) <= kSpeedTolerance)) {
    failed_ = {StopCause::kSpeedFactor, speed_factor_, kSpeedTolerance, readings.time, BenchServo::kDriving};
  } else if (!(torque_factor_ >= kLeastTorqueFactor && torque_factor_ <= kMostTorqueFactor)) {
    failed_ = {StopCause::kTorqueFactor, torque_factor_, kMostTorqueFactor - 1.0, readings.time,
               BenchServo::kLoad};
  }
  return !failed_;
}

StepResult LoadCheckProgram::Step(const Readings& readings, double elapsed_s,
                                  BenchDevices& devices) noexcept {
  if (stage_ == Stage::kBringUp) {
    const bool driving_up = BroughtUp(devices.driving);
    const bool load_up = BroughtUp(devices.load);
    if (driving_up && load_up) {
      stage_ = Stage::kSpeedUp;
      stage_start_s_ = elapsed_s;
    }
    return StepResult::kRunning;
  }
  if (stage_ == Stage::kReturn) {
    const double left_rad = start_rad_ - readings.input_angle_rad;
    const double wanted = std::clamp(kReturnGain_per_s * left_rad, -kSpeed_rad_per_s, kSpeed_rad_per_s);
    devices.driving.CommandSpeed(speed_.Step(wanted, period_s_));
    devices.load.CommandTorque(0.0);
    return std::abs(left_rad) < kReturned_rad ? StepResult::kDone : StepResult::kRunning;
  }
  devices.driving.CommandSpeed(speed_.Step(kSpeed_rad_per_s, period_s_));
  const double over_Nm = std::abs(readings.output_torque_Nm - rest_Nm_);
  if (stage_ != Stage::kSpeedUp && over_Nm > kMostCheckOvershoot * torque_Nm_) {
    failed_ = {StopCause::kTorqueOfCheck, readings.output_torque_Nm - rest_Nm_, torque_.value(),
               readings.time, BenchServo::kLoad};
    return StepResult::kFailedCheck;
  }
  asked_rad_ += speed_.value() * period_s_;
  switch (stage_) {
    case Stage::kSpeedUp: {
      const StepResult result = Hold(readings, elapsed_s, Stage::kPositive, rest_Nm_);
      if (stage_ == Stage::kPositive) {
        turned_from_rad_ = readings.input_angle_rad;
        asked_rad_ = 0.0;
      }
      return result;
    }
    case Stage::kPositive:
    case Stage::kNegative: {
      const double sign = stage_ == Stage::kPositive ? 1.0 : -1.0;
      devices.load.CommandTorque(torque_.Step(sign * torque_Nm_, period_s_));
      if (torque_.value() != sign * torque_Nm_) {
        stage_start_s_ = elapsed_s;
        return StepResult::kRunning;
      }
      return sign > 0.0 ? Hold(readings, elapsed_s, Stage::kNegative, positive_Nm_)
                        : Hold(readings, elapsed_s, Stage::kUnload, negative_Nm_);
    }
    case Stage::kUnload:
      devices.load.CommandTorque(torque_.Step(0.0, period_s_));
      if (torque_.value() != 0.0) return StepResult::kRunning;
      if (!Judge(readings)) return StepResult::kFailedCheck;
      stage_ = Stage::kReturn;
      return StepResult::kRunning;
    case Stage::kBringUp:
    case Stage::kReturn:
      break;
  }
  return StepResult::kRunning;
}

}  // namespace strainwave::bench
