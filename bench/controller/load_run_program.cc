// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/load_run_program.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "analysis/units.h"

namespace strainwave::bench {
namespace {

// A turn counts as done when this little is left of it: the approach speed falls with the root of what
// remains, and would take for ever to finish.
constexpr double kTurnTolerance_rad = 0.05;  // of the input
constexpr double kCreepSpeed_rad_per_s = 1.0;
constexpr double kParked_rad = 0.005;         // of the input
constexpr double kParkingPeriods = 10.0;      // time constant of the last segment, and at least
constexpr double kParkingAges = 3.0;          // ages of the angles, whose control loop would else swing
constexpr double kParkingDeceleration = 0.5;  // of the acceleration allowed

std::size_t ExpectedRows(const schedules::LoadRun& run) {
  return static_cast<std::size_t>(std::ceil((1.2 * run.duration_s + 61.0) * run.log_rate_hz));
}

}  // namespace

LoadRunProgram::LoadRunProgram(const schedules::LoadRun& parameters, const schedules::Specimen& specimen,
                               double credited_s, double period_s)
    : parameters_(parameters),
      ratio_(specimen.ratio),
      turn_input_rad_(parameters.turns * kTwoPi * std::abs(specimen.ratio)),
      way_s_(turn_input_rad_ / parameters.input_speed_rad_per_s +
             2.0 * parameters.input_speed_rad_per_s / parameters.input_acceleration_rad_per_s2 +
             schedules::kSettlesWithin_s),
      period_s_(period_s),
      credited_s_(credited_s),
      speed_(parameters.input_acceleration_rad_per_s2),
      torque_(parameters.torque_rate_Nm_per_s),
      watch_(parameters.tolerances, parameters.output_torque_Nm, parameters.input_speed_rad_per_s, specimen),
      log_({"time_s", "input_speed_rpm", "torque_mean_Nm", "torque_min_Nm", "torque_max_Nm",
            "motor_torque_Nm", "vibration_rms_m_per_s2", "gear_temperature_degC", "ambient_temperature_degC",
            "credited_load_s", "equivalent_load_s"},
           ExpectedRows(parameters)) {}

void LoadRunProgram::SetUp(const Readings& readings, BenchDevices& devices) {
  turn_start_rad_ = readings.input_angle_rad;
  devices.driving.Enable(DriveMode::kSpeed);
  devices.load.Enable(DriveMode::kTorque);
}

void LoadRunProgram::Collect(BenchDevices& devices) {
  if (!(parameters_.vibration_statistics_hz > 0.0)) return;
  const bool wanted = under_load_ && !winding_down_;
  if (wanted && !statistics_.running())
    statistics_.Start(devices.sampler, parameters_.vibration_statistics_hz);
  statistics_.Take(devices.sampler);
  if (!wanted && statistics_.running()) statistics_.Stop(devices.sampler);
}

StepResult LoadRunProgram::Step(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept {
  if (!under_load_) {
    const bool driving_up = BroughtUp(devices.driving);
    const bool load_up = BroughtUp(devices.load);
    under_load_ = driving_up && load_up;
    return StepResult::kRunning;
  }
  if (winding_down_) return WindDownStep(readings, devices);
  const double remaining_rad = turn_start_rad_ + direction_ * turn_input_rad_ - readings.input_angle_rad;
  if (direction_ * remaining_rad < kTurnTolerance_rad) {
    turn_start_rad_ += direction_ * turn_input_rad_;
    direction_ = -direction_;
  }
  const double approach = ApproachSpeed(remaining_rad, parameters_.input_speed_rad_per_s,
                                        parameters_.input_acceleration_rad_per_s2);
  // Never slower than a creep, so that the last fraction of a turn ends.
  const double wanted = std::copysign(std::max(std::abs(approach), kCreepSpeed_rad_per_s), direction_);
  devices.driving.CommandSpeed(speed_.Step(wanted, period_s_));
  devices.load.CommandTorque(torque_.Step(-direction_ * parameters_.output_torque_Nm, period_s_));

  Credit(readings);
  winding_down_ = credited_s_ + on_the_way_.time_s + 0.5 * period_s_ >= parameters_.duration_s;
  if (winding_down_) Commit();
  if (!Log(readings, elapsed_s)) return StepResult::kLogFull;
  return watch_.failed() ? StepResult::kFailedCheck : StepResult::kRunning;
}

void LoadRunProgram::Credit(const Readings& readings) noexcept {
  watch_.Step(torque_.value(), speed_.value(), readings, period_s_);
  if (watch_.away()) {
    on_the_way_ = {};
    return;
  }
  const double torque_share =
      parameters_.output_torque_Nm > 0.0 ? readings.output_torque_Nm / parameters_.output_torque_Nm : 0.0;
  const double speed_share = std::abs(watch_.input_speed_rad_per_s()) / parameters_.input_speed_rad_per_s;
  on_the_way_.time_s += period_s_;
  on_the_way_.equivalent_s += period_s_ * std::abs(torque_share * torque_share * torque_share) * speed_share;
  if (watch_.settled() || on_the_way_.time_s > way_s_) Commit();
}

void LoadRunProgram::Commit() noexcept {
  credited_s_.store(credited_s_ + on_the_way_.time_s, std::memory_order_relaxed);
  equivalent_s_ += on_the_way_.equivalent_s;
  on_the_way_ = {};
}

// Comes to rest without load, then parks where measurements begin: whatever is measured next starts from the
// same teeth, however the load run ended.
StepResult LoadRunProgram::WindDownStep(const Readings& readings, BenchDevices& devices) noexcept {
  const std::chrono::duration<double> age = devices.clock.Now() - readings.angles_time();
  oldest_angles_s_ = std::max(oldest_angles_s_, age.count());
  devices.load.CommandTorque(torque_.Step(0.0, period_s_));
  if (!parking_) {
    devices.driving.CommandSpeed(speed_.Step(0.0, period_s_));
    parking_ = speed_.value() == 0.0 && torque_.value() == 0.0;
    home_input_rad_ = HomeInput_rad(readings, ratio_);
    return StepResult::kRunning;
  }
  const double remaining_rad = home_input_rad_ - readings.input_angle_rad;
  const double approach = ApproachSpeed(remaining_rad, parameters_.input_speed_rad_per_s,
                                        kParkingDeceleration * parameters_.input_acceleration_rad_per_s2);
  // The last segment in proportion to what is left, which the root law would overshoot by one period.
  const double gentle =
      remaining_rad / std::max(kParkingPeriods * period_s_, kParkingAges * oldest_angles_s_);
  const double wanted = std::abs(gentle) < std::abs(approach) ? gentle : approach;
  devices.driving.CommandSpeed(speed_.Step(wanted, period_s_));
  const bool parked =
      std::abs(remaining_rad) < kParked_rad && std::abs(speed_.value()) < kParked_rad / period_s_;
  return parked ? StepResult::kDone : StepResult::kRunning;
}

bool LoadRunProgram::Log(const Readings& readings, double elapsed_s) noexcept {
  Interval& now = interval_;
  if (now.count == 0) now.torque_min_Nm = now.torque_max_Nm = readings.output_torque_Nm;
  ++now.count;
  now.torque_sum_Nm += readings.output_torque_Nm;
  now.torque_min_Nm = std::min(now.torque_min_Nm, readings.output_torque_Nm);
  now.torque_max_Nm = std::max(now.torque_max_Nm, readings.output_torque_Nm);
  now.motor_torque_sum_Nm += std::abs(readings.motor_torque_Nm);
  now.vibration_square_sum += readings.vibration_rms_m_per_s2 * readings.vibration_rms_m_per_s2;
  now.temperature_degC = readings.gear_temperature_degC;
  now.ambient_degC = readings.ambient_temperature_degC;
  now.speed_max_rad_per_s = std::max(now.speed_max_rad_per_s, std::abs(readings.input_speed_rad_per_s));
  const bool is_last = winding_down_ || watch_.failed();
  if (elapsed_s < next_row_s_ && !is_last) return true;
  next_row_s_ += 1.0 / parameters_.log_rate_hz;
  const double count = now.count;
  const bool kept = log_.Append({elapsed_s, RpmFromRadPerS(now.speed_max_rad_per_s),
                                 now.torque_sum_Nm / count, now.torque_min_Nm, now.torque_max_Nm,
                                 now.motor_torque_sum_Nm / count, std::sqrt(now.vibration_square_sum / count),
                                 now.temperature_degC, now.ambient_degC, credited_load_s(), equivalent_s_});
  now = {};
  return kept;
}

std::vector<NamedRecord> LoadRunProgram::RecordsSoFar() const {
  if (log_.rows() == 0) return {};
  NamedRecord named{"load_run", {}};
  named.record.kind = daq::RecordKind::kHistory;
  named.record.SetMetadata("log_rate_hz", parameters_.log_rate_hz);
  named.record.SetMetadata("credited_load_s", credited_load_s());
  const std::vector<std::string> single{"input_speed_rpm",
                                        "torque_mean_Nm",
                                        "torque_min_Nm",
                                        "torque_max_Nm",
                                        "motor_torque_Nm",
                                        "vibration_rms_m_per_s2",
                                        "ambient_temperature_degC",
                                        "gear_temperature_degC"};
  named.record.columns = log_.Columns(single);
  std::vector<NamedRecord> records;
  records.push_back(std::move(named));
  if (parameters_.vibration_statistics_hz > 0.0) {
    records.push_back({"vibration_statistics", statistics_.Record(parameters_.vibration_statistics_hz)});
  }
  return records;
}

}  // namespace strainwave::bench
