// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/rotation_program.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "analysis/units.h"
#include "bench/seconds.h"

namespace strainwave::bench {
namespace {

constexpr double kTorqueRate_Nm_per_s = 200.0;
// A size-20 unit breaks away at a few Ncm; ten times that moves anything that can still move.
// The brakes let go of what torque they held; the input gives way by a tenth of a radian before it stands.
constexpr double kSettle_s = 0.3;
constexpr double kBreakawayRate_Nm_per_s = 0.1;
constexpr double kMostBreakaway_Nm = 0.5;
constexpr double kBrokenAway_rad = 0.5;  // of the input
constexpr double kSpeedReached = 0.995;  // of the asked speed

double MeasureDuration(const schedules::MeasurementRotation& rotation, double ratio) {
  return rotation.turns * kTwoPi * std::abs(ratio) / rotation.input_speed_rad_per_s;
}

}  // namespace

RotationProgram::RotationProgram(const schedules::MeasurementRotation& parameters,
                                 const schedules::Specimen& specimen)
    : parameters_(parameters),
      direction_(parameters.clockwise ? 1.0 : -1.0),
      turn_input_rad_(parameters.turns * kTwoPi * std::abs(specimen.ratio)),
      breakaway_(kBreakawayRate_Nm_per_s),
      speed_(parameters.input_acceleration_rad_per_s2),
      torque_(kTorqueRate_Nm_per_s),
      watch_(parameters.tolerances, parameters.output_torque_Nm, parameters.input_speed_rad_per_s, specimen),
      breakaway_log_({"time_s", "position_rad", "velocity_rad_per_s", "torque_Nm", "temperature_degC"},
                     static_cast<std::size_t>((kMostBreakaway_Nm / kBreakawayRate_Nm_per_s + 1.0) *
                                              parameters.log_rate_hz)),
      log_({"time_s", "position_rad", "velocity_rad_per_s", "torque_Nm", "output_angle_deg",
            "output_torque_Nm", "temperature_degC"},
           static_cast<std::size_t>(1.1 * MeasureDuration(parameters, specimen.ratio) *
                                    parameters.log_rate_hz) +
               64) {}

double RotationProgram::timeout_s() const {
  return 1.5 * turn_input_rad_ / parameters_.input_speed_rad_per_s + 60.0;
}

void RotationProgram::SetUp(const Readings&, BenchDevices& devices) {
  const auto samples = static_cast<std::size_t>(1.1 * turn_input_rad_ / parameters_.input_speed_rad_per_s *
                                                parameters_.vibration_rate_hz);
  for (auto* channel : {&vibration_.accel_x_m_per_s2, &vibration_.accel_y_m_per_s2,
                        &vibration_.accel_z_m_per_s2, &vibration_.accel_motor_z_m_per_s2}) {
    channel->reserve(samples);
  }
  devices.driving.Enable(DriveMode::kTorque);
  devices.load.Enable(DriveMode::kTorque);
}

StepResult RotationProgram::Step(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept {
  alignment_.Push(readings);
  const double period_s = control_period_s();
  const double speed = direction_ * parameters_.input_speed_rad_per_s;
  switch (stage_) {
    case Stage::kBringUp: {
      const bool driving_up = BroughtUp(devices.driving);
      const bool load_up = BroughtUp(devices.load);
      if (driving_up && load_up) {
        stage_ = Stage::kSettle;
        start_s_ = elapsed_s;
      }
      return StepResult::kRunning;
    }
    case Stage::kSettle:
      if (elapsed_s - start_s_ < kSettle_s) return StepResult::kRunning;
      rest_rad_ = readings.input_angle_rad;
      start_s_ = elapsed_s;
      alignment_.BeginAfter(devices.clock.Now());
      stage_ = Stage::kBreakAway;
      return StepResult::kRunning;
    case Stage::kBreakAway:
      return BreakAway(readings, elapsed_s, devices);
    case Stage::kChangeMode:
      if (BroughtUp(devices.driving)) stage_ = Stage::kRunUp;
      return StepResult::kRunning;
    case Stage::kRunUp:
      devices.driving.CommandSpeed(speed_.Step(speed, period_s));
      devices.load.CommandTorque(torque_.Step(-direction_ * parameters_.output_torque_Nm, period_s));
      watch_.Step(torque_.value(), speed_.value(), readings, period_s);
      if (watch_.failed()) return StepResult::kFailedCheck;
      if (std::abs(readings.input_speed_rad_per_s) > kSpeedReached * parameters_.input_speed_rad_per_s &&
          torque_.value() == -direction_ * parameters_.output_torque_Nm) {
        start_s_ = elapsed_s;
        // A sample of this very moment is at speed as well.
        alignment_.BeginAfter(devices.clock.Now() - std::chrono::nanoseconds(1));
        stage_ = Stage::kMeasure;
      }
      return StepResult::kRunning;
    case Stage::kMeasure:
      return Measure(readings, elapsed_s, devices);
    case Stage::kRunDown:
      devices.driving.CommandSpeed(speed_.Step(0.0, period_s));
      devices.load.CommandTorque(torque_.Step(0.0, period_s));
      return speed_.value() == 0.0 && torque_.value() == 0.0 ? StepResult::kDone : StepResult::kRunning;
  }
  return StepResult::kRunning;
}

StepResult RotationProgram::Measure(const Readings& readings, double elapsed_s,
                                    BenchDevices& devices) noexcept {
  watch_.Step(torque_.value(), speed_.value(), readings, control_period_s());
  if (watch_.failed()) return StepResult::kFailedCheck;
  const std::chrono::nanoseconds now = devices.clock.Now();
  while (const std::optional<AlignedSample> sample = alignment_.Next()) {
    if (!measure_from_rad_) {
      measure_from_rad_ = sample->input_angle_rad;
      continue;
    }
    const double travelled = direction_ * (sample->input_angle_rad - *measure_from_rad_);
    share_done_ = std::clamp(travelled / turn_input_rad_, 0.0, 1.0);
    if (travelled >= turn_input_rad_) {
      // A turn may be shorter than the dwell: what was measured at another load is no measurement.
      failed_ = watch_.away_reason();
      if (failed_) return StepResult::kFailedCheck;
      stage_ = Stage::kRunDown;
      return StepResult::kRunning;
    }
    const bool kept = log_.Append({elapsed_s - start_s_ - Seconds(now - sample->time),
                                   sample->input_angle_rad, sample->input_speed_rad_per_s,
                                   sample->motor_torque_Nm, DegFromRad(sample->output_angle_rad),
                                   sample->output_torque_Nm, readings.gear_temperature_degC});
    if (!kept) return StepResult::kLogFull;
  }
  return StepResult::kRunning;
}

StepResult RotationProgram::BreakAway(const Readings& readings, double elapsed_s,
                                      BenchDevices& devices) noexcept {
  const std::chrono::nanoseconds now = devices.clock.Now();
  bool moved = false;
  while (const std::optional<AlignedSample> sample = alignment_.Next()) {
    const bool kept = breakaway_log_.Append({elapsed_s - start_s_ - Seconds(now - sample->time),
                                             sample->input_angle_rad, sample->input_speed_rad_per_s,
                                             sample->motor_torque_Nm, readings.gear_temperature_degC});
    if (!kept) return StepResult::kLogFull;
    moved = moved || std::abs(sample->input_angle_rad - rest_rad_) > kBrokenAway_rad;
  }
  if (moved || std::abs(breakaway_.value()) >= kMostBreakaway_Nm) {
    devices.driving.Enable(DriveMode::kSpeed);
    stage_ = Stage::kChangeMode;
    return StepResult::kRunning;
  }
  devices.driving.CommandTorque(breakaway_.Step(direction_ * kMostBreakaway_Nm, control_period_s()));
  return StepResult::kRunning;
}

void RotationProgram::Collect(BenchDevices& devices) {
  const bool wanted = stage_ == Stage::kMeasure;
  if (wanted && !vibration_running_) devices.sampler.StartVibration(parameters_.vibration_rate_hz);
  if (vibration_running_) devices.sampler.DrainVibration(vibration_);
  if (!wanted && vibration_running_) devices.sampler.StopVibration();
  vibration_running_ = wanted;
}

std::vector<NamedRecord> RotationProgram::TakeRecords() {
  NamedRecord vibration{"vibration", {}};
  vibration.record.kind = daq::RecordKind::kVibration;
  vibration.record.SetMetadata("sample_rate_hz", parameters_.vibration_rate_hz);
  vibration.record.SetMetadata("input_speed_rpm", RpmFromRadPerS(parameters_.input_speed_rad_per_s));
  vibration.record.SetMetadata("direction", parameters_.clockwise ? "cw" : "ccw");
  if (vibration_.lost_samples > 0) {
    vibration.record.SetMetadata("lost_samples", std::to_string(vibration_.lost_samples));
  }
  const auto add = [&](const char* name, std::vector<float>& samples) {
    vibration.record.columns.push_back({name, std::move(samples), {}, {}});
  };
  add("accel_x_m_per_s2", vibration_.accel_x_m_per_s2);
  add("accel_y_m_per_s2", vibration_.accel_y_m_per_s2);
  add("accel_z_m_per_s2", vibration_.accel_z_m_per_s2);
  add("accel_motor_z_m_per_s2", vibration_.accel_motor_z_m_per_s2);

  NamedRecord rotation{"rotation", {}};
  rotation.record.kind = daq::RecordKind::kMotion;
  rotation.record.SetMetadata("sample_rate_hz", parameters_.log_rate_hz);
  const std::vector<std::string> single{"torque_Nm", "output_torque_Nm", "temperature_degC",
                                        "velocity_rad_per_s"};
  rotation.record.columns = log_.Columns(single);
  NamedRecord breakaway{"breakaway", {}};
  breakaway.record.kind = daq::RecordKind::kMotion;
  breakaway.record.SetMetadata("sample_rate_hz", parameters_.log_rate_hz);
  breakaway.record.columns = breakaway_log_.Columns(single);
  std::vector<NamedRecord> records;
  records.push_back(std::move(breakaway));
  records.push_back(std::move(vibration));
  records.push_back(std::move(rotation));
  return records;
}

}  // namespace strainwave::bench
