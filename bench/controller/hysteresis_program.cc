// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/hysteresis_program.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "analysis/units.h"
#include "bench/seconds.h"

namespace strainwave::bench {
namespace {

constexpr double kTurnSpeed_rad_per_s = RadPerSFromRpm(300.0);
constexpr double kTurnAcceleration_rad_per_s2 = 1000.0;
constexpr double kMostOvershoot = 1.1;  // of the torque that the load servo is asked for
// Of the peak: the overshoot, and what friction between load servo and transducer keeps.
constexpr double kTorqueTolerance = 0.25;
constexpr double kTorqueDwell_s = 2.0;
constexpr double kLockSettle_s = 0.3;  // brake closed and torque off before the load comes on

}  // namespace

HysteresisProgram::HysteresisProgram(const schedules::HysteresisTest& parameters,
                                     const schedules::Specimen& specimen, double period_s)
    : parameters_(parameters), specimen_(specimen), period_s_(period_s) {
  const double peak = parameters_.peak_torque_Nm;
  const int loops = static_cast<int>(std::ceil(parameters_.loops));
  peaks_Nm_.push_back(peak);
  for (int loop = 0; loop < loops; ++loop) {
    peaks_Nm_.push_back(-peak);
    peaks_Nm_.push_back(peak);
  }
  peaks_Nm_.push_back(0.0);
  const auto rows = static_cast<std::size_t>((1.1 * loop_s() + 5.0) * parameters_.log_rate_hz);
  for (std::size_t i = 0; i < parameters_.lock_angles_rad.size(); ++i) {
    logs_.emplace_back(std::vector<std::string>{"time_s", "torque_Nm", "output_angle_deg", "input_angle_deg",
                                                "temperature_degC"},
                       rows);
  }
}

double HysteresisProgram::loop_s() const {
  double travel_Nm = 0.0;
  double from_Nm = 0.0;
  for (const double peak : peaks_Nm_) {
    travel_Nm += std::abs(peak - from_Nm);
    from_Nm = peak;
  }
  return travel_Nm / parameters_.torque_rate_Nm_per_s +
         parameters_.hold_s * static_cast<double>(peaks_Nm_.size());
}

double HysteresisProgram::share_done() const noexcept {
  double rows = 0.0;
  for (const RowLog& log : logs_) rows += static_cast<double>(log.rows());
  return std::min(1.0, rows / (angles() * loop_s() * parameters_.log_rate_hz));
}

void HysteresisProgram::SetUp(const Readings&, BenchDevices& devices) {
  devices.driving.Enable(DriveMode::kPosition);
  devices.load.Enable(DriveMode::kTorque);
}

void HysteresisProgram::BeginAngle(const Readings& readings, const ServoDrive& driving,
                                   double elapsed_s) noexcept {
  drive_ahead_rad_ = DriveAhead_rad(readings, driving);
  // The nearest turn of the wave generator that stands at the asked angle.
  const double asked = parameters_.lock_angles_rad[angle_];
  const double turns = std::round((readings.input_angle_rad - asked) / kTwoPi);
  target_rad_ = asked + kTwoPi * turns;
  move_ =
      PointToPoint(readings.input_angle_rad, target_rad_, kTurnSpeed_rad_per_s, kTurnAcceleration_rad_per_s2);
  stage_ = Stage::kTurnToAngle;
  stage_start_s_ = elapsed_s;
}

// The load servo commands its own torque; friction between it and the transducer keeps some of it. So the
// ramp goes on until the transducer has seen the peak, up to a share above it.
bool HysteresisProgram::Ramped(const Readings& readings) noexcept {
  const double peak_Nm = peaks_Nm_[peak_];
  greatest_Nm_ = std::max(greatest_Nm_, std::copysign(1.0, peak_Nm) * readings.output_torque_Nm);
  const double most_Nm = kMostOvershoot * peak_Nm;
  torque_->Step(most_Nm, period_s_);
  if (torque_->value() == most_Nm) return true;
  return peak_Nm != 0.0 && std::copysign(1.0, peak_Nm) * (readings.output_torque_Nm - peak_Nm) >= 0.0;
}

// A loop may be over before the watch's dwell is: its peaks have to be there whatever the rate.
StopReason HysteresisProgram::PeakAway(const Readings& readings) const noexcept {
  const double peak_Nm = peaks_Nm_[peak_];
  if (greatest_Nm_ >= (1.0 - kTorqueTolerance) * std::abs(peak_Nm)) return {};
  return {StopCause::kTorqueAway, std::copysign(greatest_Nm_, peak_Nm), peak_Nm, readings.time,
          BenchServo::kLoad};
}

// Rows of torque and angles of one moment each; none where nothing new has come. A torque that is sampled
// more slowly than the angles makes one row a sample: between two of its own it would say nothing new.
bool HysteresisProgram::LogRows(const Readings& readings, double elapsed_s,
                                std::chrono::nanoseconds now) noexcept {
  alignment_.Push(readings);
  while (const std::optional<AlignedSample> sample = alignment_.Next()) {
    const double sampled_s = elapsed_s - Seconds(now - sample->time);
    const double time_s = sampled_s - loop_start_s_;
    if (!sample->has_new_torque || time_s < 0.0 || sampled_s + 0.5 * period_s_ < next_row_s_) continue;
    next_row_s_ += 1.0 / parameters_.log_rate_hz;
    if (!logs_[angle_].Append({time_s, sample->output_torque_Nm, DegFromRad(sample->output_angle_rad),
                               DegFromRad(sample->input_angle_rad), readings.gear_temperature_degC})) {
      return false;
    }
  }
  return true;
}

StepResult HysteresisProgram::Step(const Readings& readings, double elapsed_s,
                                   BenchDevices& devices) noexcept {
  const double in_stage_s = elapsed_s - stage_start_s_;
  switch (stage_) {
    case Stage::kBringUp: {
      const bool driving_up = BroughtUp(devices.driving);
      const bool load_up = BroughtUp(devices.load);
      if (driving_up && load_up) BeginAngle(readings, devices.driving, elapsed_s);
      return StepResult::kRunning;
    }
    case Stage::kTurnToAngle:
      devices.driving.CommandPosition(move_.PositionAt(in_stage_s) + drive_ahead_rad_);
      if (in_stage_s < move_.duration_s()) move_ended_ = devices.clock.Now();
      if (in_stage_s < move_.duration_s() + kLockSettle_s || readings.angles_time() < move_ended_)
        return StepResult::kRunning;
      failed_ = PositionAway(target_rad_, readings);
      if (failed_) return StepResult::kFailedCheck;
      devices.driving.SetBrake(true);
      devices.driving.Disable();
      stage_ = Stage::kLock;
      stage_start_s_ = elapsed_s;
      return StepResult::kRunning;
    case Stage::kLock:
      if (in_stage_s < kLockSettle_s) return StepResult::kRunning;
      if (!devices.driving.Actual().brake_engaged) return StepResult::kRunning;
      locked_output_rad_ = readings.output_angle_rad;
      torque_.emplace(parameters_.torque_rate_Nm_per_s);
      torque_watch_.emplace(kTorqueTolerance * parameters_.peak_torque_Nm, kTorqueDwell_s);
      peak_ = 0;
      greatest_Nm_ = 0.0;
      hold_until_s_ = -1.0;
      alignment_ = {};
      loop_start_s_ = next_row_s_ = elapsed_s;
      stage_ = Stage::kRamp;
      [[fallthrough]];
    case Stage::kRamp: {
      if (hold_until_s_ < 0.0 && Ramped(readings)) hold_until_s_ = elapsed_s + parameters_.hold_s;
      devices.load.CommandTorque(torque_->value());
      torque_watch_->Step(torque_->value(), readings.output_torque_Nm, readings.torque_time, period_s_);
      if (torque_watch_->is_away_for_too_long()) {
        failed_ = {StopCause::kTorqueAway, torque_watch_->measured(), torque_watch_->set_point(),
                   readings.time, BenchServo::kLoad};
        return StepResult::kFailedCheck;
      }
      if (hold_until_s_ >= 0.0 && elapsed_s >= hold_until_s_) {
        failed_ = PeakAway(readings);
        if (failed_) return StepResult::kFailedCheck;
        ++peak_;
        greatest_Nm_ = 0.0;
        hold_until_s_ = -1.0;
      }
      if (!LogRows(readings, elapsed_s, devices.clock.Now())) return StepResult::kLogFull;
      if (peak_ < peaks_Nm_.size()) return StepResult::kRunning;
      if (++angle_ == parameters_.lock_angles_rad.size()) return StepResult::kDone;
      stage_ = Stage::kRelease;
      stage_start_s_ = elapsed_s;
      devices.driving.Enable(DriveMode::kPosition);
      return StepResult::kRunning;
    }
    case Stage::kRelease:
      if (BroughtUp(devices.driving)) BeginAngle(readings, devices.driving, elapsed_s);
      return StepResult::kRunning;
  }
  return StepResult::kRunning;
}

std::vector<NamedRecord> HysteresisProgram::TakeRecords() {
  std::vector<NamedRecord> records;
  for (std::size_t i = 0; i < logs_.size(); ++i) {
    if (logs_[i].rows() == 0) continue;
    NamedRecord named{fmt::format("hysteresis_{}", i + 1), {}};
    named.record.kind = daq::RecordKind::kHysteresis;
    named.record.SetMetadata("t1_Nm", specimen_.t1_Nm);
    named.record.SetMetadata("t2_Nm", specimen_.t2_Nm);
    named.record.SetMetadata("t3_Nm", specimen_.t3_Nm);
    named.record.SetMetadata("lock_angle_deg", DegFromRad(parameters_.lock_angles_rad[i]));
    named.record.SetMetadata("sample_rate_hz", parameters_.log_rate_hz);
    named.record.columns = logs_[i].Columns();
    records.push_back(std::move(named));
  }
  return records;
}

}  // namespace strainwave::bench
