// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/sweep_program.h"

#include <cmath>

#include "analysis/units.h"
#include "bench/safety/set_point_watch.h"
#include "bench/seconds.h"

namespace strainwave::bench {
namespace {

constexpr double kApproachFromBehind_rad = RadFromDeg(5.0);  // of the output

}  // namespace

SweepProgram::SweepProgram(const schedules::TransmissionErrorSweep& parameters, double ratio, double period_s)
    : parameters_(parameters),
      ratio_(ratio),
      period_s_(period_s),
      direction_(parameters.clockwise ? 1.0 : -1.0),
      second_direction_(parameters.clockwise && parameters.counter_clockwise),
      log_({"time_s", "direction", "input_angle_deg", "output_angle_deg", "torque_Nm", "temperature_degC"},
           2 * (static_cast<std::size_t>(parameters.steps) + 1)),
      skew_(ratio) {
  output_speeds_rad_per_s_.reserve(2 * (static_cast<std::size_t>(parameters.steps) + 1));
}

double SweepProgram::timeout_s() const {
  const double turn_s =
      std::abs(ratio_) * parameters_.step_rad * parameters_.steps / parameters_.input_speed_rad_per_s;
  return 60.0 + 4.0 * (turn_s + parameters_.steps * (parameters_.settle_s + parameters_.averaging_s + 0.5));
}

double SweepProgram::share_done() const noexcept {
  const double directions = parameters_.clockwise && parameters_.counter_clockwise ? 2.0 : 1.0;
  return static_cast<double>(log_.rows()) / (directions * (parameters_.steps + 1));
}

void SweepProgram::SetUp(const Readings& readings, BenchDevices& devices) {
  home_input_rad_ = HomeInput_rad(readings, ratio_);
  devices.driving.Enable(DriveMode::kPosition);
  devices.load.Enable(DriveMode::kTorque);
}

double SweepProgram::StepTarget(int step) const noexcept {
  const int from_home = direction_ > 0.0 ? step : parameters_.steps - step;
  return home_input_rad_ + ratio_ * parameters_.step_rad * from_home;
}

void SweepProgram::MoveTo(double input_rad, double elapsed_s) noexcept {
  move_ = PointToPoint(target_rad_, input_rad, parameters_.input_speed_rad_per_s,
                       parameters_.input_acceleration_rad_per_s2);
  skew_.BeginMove(std::copysign(1.0, (input_rad - target_rad_) / ratio_));
  target_rad_ = input_rad;
  stage_start_s_ = elapsed_s;
}

void SweepProgram::BeginDirection(double direction, double elapsed_s) noexcept {
  direction_ = direction;
  step_ = 0;
  stage_ = Stage::kApproach;
  MoveTo(StepTarget(0) - direction_ * ratio_ * kApproachFromBehind_rad, elapsed_s);
}

void SweepProgram::FollowMove() noexcept {
  while (const std::optional<AlignedSample> sample = alignment_.Next()) {
    skew_.Add(*sample);
    newest_ = *sample;
  }
}

void SweepProgram::BeginAverage(double elapsed_s) noexcept {
  stage_ = Stage::kAverage;
  count_ = 0;
  input_sum_rad_ = output_sum_rad_ = torque_sum_Nm_ = speed_sum_rad_per_s_ = 0.0;
  input_start_rad_ = newest_.input_angle_rad;
  output_start_rad_ = newest_.output_angle_rad;
  stage_start_s_ = elapsed_s;
  AddToAverage(newest_);
}

void SweepProgram::AddToAverage(const AlignedSample& sample) noexcept {
  ++count_;
  input_sum_rad_ += sample.input_angle_rad - input_start_rad_;
  output_sum_rad_ += sample.output_angle_rad - output_start_rad_;
  torque_sum_Nm_ += sample.output_torque_Nm;
  speed_sum_rad_per_s_ += sample.input_speed_rad_per_s / ratio_;
  newest_ = sample;
}

bool SweepProgram::LogAverage(const Readings& readings, double elapsed_s,
                              std::chrono::nanoseconds now) noexcept {
  const bool kept = log_.Append({elapsed_s - Seconds(now - newest_.time), direction_,
                                 DegFromRad(input_start_rad_ + input_sum_rad_ / count_),
                                 DegFromRad(output_start_rad_ + output_sum_rad_ / count_),
                                 torque_sum_Nm_ / count_, readings.gear_temperature_degC});
  if (kept) output_speeds_rad_per_s_.push_back(speed_sum_rad_per_s_ / count_);
  return kept;
}

StepResult SweepProgram::Step(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept {
  alignment_.Push(readings);
  const double in_stage_s = elapsed_s - stage_start_s_;
  switch (stage_) {
    case Stage::kBringUp: {
      const bool driving_up = BroughtUp(devices.driving);
      const bool load_up = BroughtUp(devices.load);
      if (driving_up && load_up) {
        target_rad_ = readings.input_angle_rad;
        drive_ahead_rad_ = DriveAhead_rad(readings, devices.driving);
        BeginDirection(direction_, elapsed_s);
      }
      return StepResult::kRunning;
    }
    case Stage::kApproach:
    case Stage::kMove:
      devices.driving.CommandPosition(move_.PositionAt(in_stage_s) + drive_ahead_rad_);
      FollowMove();
      if (in_stage_s < move_.duration_s()) return StepResult::kRunning;
      if (stage_ == Stage::kApproach) {
        MoveTo(StepTarget(0), elapsed_s);
        stage_ = Stage::kMove;
      } else {
        stage_ = Stage::kSettle;
        stage_start_s_ = elapsed_s;
      }
      return StepResult::kRunning;
    case Stage::kSettle:
      FollowMove();
      // By the sample's own time: what was sampled before the shafts had settled says nothing of where they
      // did. The runner watches how old it is.
      if (in_stage_s - Seconds(devices.clock.Now() - newest_.time) < parameters_.settle_s)
        return StepResult::kRunning;
      failed_ = PositionAway(target_rad_, readings);
      if (failed_) return StepResult::kFailedCheck;
      BeginAverage(elapsed_s);
      [[fallthrough]];
    case Stage::kAverage: {
      while (const std::optional<AlignedSample> sample = alignment_.Next()) AddToAverage(*sample);
      if (elapsed_s - stage_start_s_ + 0.5 * period_s_ < parameters_.averaging_s) return StepResult::kRunning;
      if (!LogAverage(readings, elapsed_s, devices.clock.Now())) return StepResult::kLogFull;
      if (step_ == parameters_.steps) {
        if (!second_direction_) return StepResult::kDone;
        second_direction_ = false;
        BeginDirection(-direction_, elapsed_s);
        return StepResult::kRunning;
      }
      MoveTo(StepTarget(++step_), elapsed_s);
      stage_ = Stage::kMove;
      return StepResult::kRunning;
    }
  }
  return StepResult::kRunning;
}

void SweepProgram::TakeOut(double skew_s, daq::Record& record) const {
  for (daq::Column& column : record.columns) {
    if (column.name != "output_angle_deg") continue;
    auto& angles_deg = std::get<std::vector<double>>(column.values);
    for (std::size_t i = 0; i < angles_deg.size(); ++i) {
      angles_deg[i] -= DegFromRad(skew_s * output_speeds_rad_per_s_[i]);
    }
  }
}

std::vector<NamedRecord> SweepProgram::TakeRecords() {
  NamedRecord named{"transmission_error", {}};
  named.record.kind = daq::RecordKind::kTransmissionError;
  named.record.SetMetadata("ratio", ratio_);
  named.record.SetMetadata("step_deg", DegFromRad(parameters_.step_rad));
  named.record.columns = log_.Columns();
  if (const auto skew = skew_.Estimate()) {
    named.record.SetMetadata("encoder_skew_us", 1e6 * skew->skew_s);
    named.record.SetMetadata("encoder_skew_se_us", 1e6 * skew->standard_error_s);
    named.record.SetMetadata("encoder_skew_taken_out", "true");
    TakeOut(skew->skew_s, named.record);
  }
  for (daq::Column& column : named.record.columns) {
    if (column.name != "direction") continue;
    std::vector<daq::Direction> directions;
    for (const double sign : std::get<std::vector<double>>(column.values)) {
      directions.push_back(sign > 0.0 ? daq::Direction::kClockwise : daq::Direction::kCounterClockwise);
    }
    column.values = std::move(directions);
  }
  std::vector<NamedRecord> records;
  records.push_back(std::move(named));
  return records;
}

}  // namespace strainwave::bench
