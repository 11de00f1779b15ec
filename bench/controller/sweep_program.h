// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/controller/encoder_skew.h"
#include "bench/controller/motion.h"
#include "bench/controller/phase_program.h"
#include "bench/controller/row_log.h"
#include "bench/controller/sample_alignment.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// Transmission error at standstill: from the output's reference angle in equal steps through the asked
/// angle, reading both encoders after each step, clockwise and then counter-clockwise. Before each direction
/// the output comes from behind, so that the first reading has the same history as the others.
/// `steps` moves give `steps` + 1 readings. While it moves, the time between the two encoders is measured
/// (docs/effects.md E20), and taken out of the readings where they were not quite at rest. A reading is a
/// mean over samples of both encoders and of the torque at one moment each (`SampleAlignment`), and has the
/// time of the last of them.
class SweepProgram final : public PhaseProgram {
 public:
  SweepProgram(const schedules::TransmissionErrorSweep& parameters, double ratio, double period_s);

  void SetUp(const Readings& readings, BenchDevices& devices) override;
  StepResult Step(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept override;
  double control_period_s() const override { return period_s_; }
  double timeout_s() const override;
  double share_done() const noexcept override;
  StopReason failed_check() const noexcept override { return failed_; }
  std::vector<NamedRecord> TakeRecords() override;

 private:
  enum class Stage { kBringUp, kApproach, kMove, kSettle, kAverage };

  void MoveTo(double input_rad, double elapsed_s) noexcept;
  double StepTarget(int step) const noexcept;
  void TakeOut(double skew_s, daq::Record& record) const;
  void BeginDirection(double direction, double elapsed_s) noexcept;
  void FollowMove() noexcept;
  void BeginAverage(double elapsed_s) noexcept;
  void AddToAverage(const AlignedSample& sample) noexcept;
  bool LogAverage(const Readings& readings, double elapsed_s, std::chrono::nanoseconds now) noexcept;

  schedules::TransmissionErrorSweep parameters_;
  double ratio_;
  double period_s_;
  Stage stage_{Stage::kBringUp};
  double direction_{1.0};
  bool second_direction_{};
  double home_input_rad_{};
  double target_rad_{};
  double drive_ahead_rad_{};
  int step_{};
  PointToPoint move_;
  double stage_start_s_{};
  SampleAlignment alignment_;
  AlignedSample newest_;  // of both encoders
  // Sums over the averaging time, relative to its first reading, so that no digits are lost.
  int count_{};
  double input_start_rad_{}, output_start_rad_{};
  double input_sum_rad_{}, output_sum_rad_{}, torque_sum_Nm_{};
  RowLog log_;
  std::vector<double> output_speeds_rad_per_s_;  // mean while a row was averaged, as many as rows
  double speed_sum_rad_per_s_{};
  EncoderSkew skew_;
  StopReason failed_;
};

}  // namespace strainwave::bench
