// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/sensor_check_program.h"

#include <algorithm>
#include <cmath>

#include "analysis/units.h"

namespace strainwave::bench {
namespace {

using Kind = schedules::SensorCheck::Kind;

// The gear unwinds when the brakes have closed; a shunt passes the amplifier's filter.
constexpr double kSensorSettle_s = 1.0;

// To and fro once a second, each time by a tenth less: at last by 2 % of T2.
constexpr double kDither_Hz = 1.0;
constexpr double kDither_s = 18.0;
constexpr double kDecay_per_s = 0.21;
// What does not reach half of T2 in two periods does not free the gear.
constexpr double kFirstPeriods_s = 2.0 / kDither_Hz;
constexpr double kLeastOfFirst = 0.5;

double Segments(const schedules::SensorCheck& check) { return check.kind == Kind::kShunt ? 2.0 : 1.0; }

std::vector<std::string> ColumnsOf(Kind kind) {
  if (kind == Kind::kReference) return {"time_s", "input_angle_deg", "output_angle_deg"};
  return {"time_s", "shunt", "torque_Nm"};
}

}  // namespace

SensorCheckProgram::SensorCheckProgram(const schedules::SensorCheck& parameters,
                                       const schedules::Specimen& specimen, double period_s)
    : parameters_(parameters),
      ratio_(specimen.ratio),
      first_Nm_(specimen.t2_Nm),
      stage_(parameters.kind == Kind::kZero ? Stage::kBringUp : Stage::kRead),
      planned_s_(Segments(parameters) * (parameters.duration_s + kSensorSettle_s) +
                 (parameters.kind == Kind::kZero ? kDither_s : 0.0)),
      log_(ColumnsOf(parameters.kind),
           static_cast<std::size_t>(Segments(parameters) * (parameters.duration_s / period_s + 2.0))) {}

void SensorCheckProgram::SetUp(const Readings&, BenchDevices& devices) {
  devices.driving.Disable();
  if (stage_ == Stage::kBringUp) {
    devices.load.Enable(DriveMode::kTorque);
  } else {
    devices.load.Disable();
  }
}

// False where the load servo does not give what it is asked for.
bool SensorCheckProgram::Dither(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept {
  if (stage_ == Stage::kBringUp) {
    if (!BroughtUp(devices.load)) return true;
    stage_ = Stage::kDither;
    locked_output_rad_ = readings.output_angle_rad;
    segment_start_s_ = elapsed_s;
  }
  const double in_segment_s = elapsed_s - segment_start_s_;
  if (in_segment_s < kFirstPeriods_s) {
    most_seen_Nm_ = std::max(most_seen_Nm_, std::abs(readings.output_torque_Nm));
  } else if (most_seen_Nm_ < kLeastOfFirst * first_Nm_) {
    failed_ = {StopCause::kTorqueAway, most_seen_Nm_, first_Nm_, readings.time, BenchServo::kLoad};
    return false;
  }
  if (in_segment_s < kDither_s) {
    devices.load.CommandTorque(first_Nm_ * std::exp(-kDecay_per_s * in_segment_s) *
                               std::sin(kTwoPi * kDither_Hz * in_segment_s));
    return true;
  }
  devices.load.SetBrake(true);
  devices.load.Disable();
  stage_ = Stage::kRead;
  segment_start_s_ = elapsed_s;
  return true;
}

StepResult SensorCheckProgram::Step(const Readings& readings, double elapsed_s,
                                    BenchDevices& devices) noexcept {
  share_done_ = std::min(1.0, elapsed_s / planned_s_);
  if (stage_ != Stage::kRead) {
    return Dither(readings, elapsed_s, devices) ? StepResult::kRunning : StepResult::kFailedCheck;
  }
  const double in_segment_s = elapsed_s - segment_start_s_;
  if (in_segment_s < kSensorSettle_s) return StepResult::kRunning;
  const bool kept = parameters_.kind == Kind::kReference
                        ? log_.Append({elapsed_s, DegFromRad(readings.input_angle_rad),
                                       DegFromRad(readings.output_angle_rad)})
                        : log_.Append({elapsed_s, shunted_ ? 1.0 : 0.0, readings.output_torque_Nm});
  if (!kept) return StepResult::kLogFull;
  if (in_segment_s < kSensorSettle_s + parameters_.duration_s) return StepResult::kRunning;
  if (parameters_.kind == Kind::kShunt && !shunted_) {
    devices.sampler.ConnectShunt(true);
    shunted_ = true;
    segment_start_s_ = elapsed_s;
    return StepResult::kRunning;
  }
  return StepResult::kDone;  // on every way out of a phase the runner takes the shunt off
}

std::vector<NamedRecord> SensorCheckProgram::TakeRecords() {
  NamedRecord named{"check", {}};
  named.record.kind = daq::RecordKind::kHistory;
  named.record.SetMetadata("check", schedules::KindName(parameters_));
  const bool angle = parameters_.kind == Kind::kReference;
  const char* const unit = angle ? "arcmin" : "Nm";
  const auto set = [&](const char* name, double value) {
    named.record.SetMetadata(std::string(name) + unit, angle ? ArcminFromRad(value) : value);
  };
  if (!angle) set("expected_", parameters_.expected_Nm);
  set("allowed_", parameters_.allowed);
  set("most_noise_", parameters_.most_noise);
  named.record.SetMetadata("ratio", ratio_);
  named.record.columns = log_.Columns();
  std::vector<NamedRecord> records;
  records.push_back(std::move(named));
  return records;
}

}  // namespace strainwave::bench
