// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "bench/controller/motion.h"
#include "bench/controller/phase_program.h"
#include "bench/controller/row_log.h"
#include "bench/controller/sample_alignment.h"
#include "bench/safety/set_point_watch.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// One rotation of the output at constant speed with raw vibration. Begins with the unloaded gear's
/// breakaway: the motor's torque is raised slowly until the input moves. Then runs up, keeps exactly the
/// asked turns at speed, runs down. Records: `breakaway` and `rotation` (kind motion: angles, torques,
/// temperature at the log rate), and `vibration` (accelerometers). A row is of the moment of a sample of the
/// output angle (`SampleAlignment`), and so is its time; the temperature is the newest one.
class RotationProgram final : public PhaseProgram {
 public:
  RotationProgram(const schedules::MeasurementRotation& parameters, const schedules::Specimen& specimen);

  void SetUp(const Readings& readings, BenchDevices& devices) override;
  StepResult Step(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept override;
  void Collect(BenchDevices& devices) override;
  double control_period_s() const override { return 1.0 / parameters_.log_rate_hz; }
  double timeout_s() const override;
  double share_done() const noexcept override { return share_done_; }
  StopReason failed_check() const noexcept override { return failed_ ? failed_ : watch_.failed(); }
  std::vector<NamedRecord> TakeRecords() override;

 private:
  enum class Stage { kBringUp, kSettle, kBreakAway, kChangeMode, kRunUp, kMeasure, kRunDown };

  StepResult BreakAway(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept;
  StepResult Measure(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept;

  schedules::MeasurementRotation parameters_;
  double direction_;
  double turn_input_rad_;
  Stage stage_{Stage::kBringUp};
  SampleAlignment alignment_;
  double rest_rad_{};                       // input angle before the breakaway
  std::optional<double> measure_from_rad_;  // input angle of the first sample at speed
  double start_s_{};
  double share_done_{};
  bool vibration_running_{};
  Ramp breakaway_;
  Ramp speed_;
  Ramp torque_;
  LoadWatch watch_;
  StopReason failed_;
  VibrationBlock vibration_;
  RowLog breakaway_log_;
  RowLog log_;
};

}  // namespace strainwave::bench
