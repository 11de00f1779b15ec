// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/controller/phase_program.h"
#include "bench/controller/row_log.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// Reads a sensor at standstill, with torque off and brakes on: the torque transducer as it is, without and
/// then with its shunt, or both encoders. Judges nothing; its record says what was to be expected.
///
/// Friction of the load drive holds the gear wound up after whatever turned last. Before the zero is read,
/// the load servo takes that off on the locked input by dither: a sinusoidal torque of T2 that decays. What
/// it leaves is a tenth of the friction; what is locked in otherwise counts as shown by the transducer.
class SensorCheckProgram final : public PhaseProgram {
 public:
  SensorCheckProgram(const schedules::SensorCheck& parameters, const schedules::Specimen& specimen,
                     double period_s);

  void SetUp(const Readings& readings, BenchDevices& devices) override;
  StepResult Step(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept override;
  double timeout_s() const override { return 2.0 * planned_s_ + 30.0; }
  double share_done() const noexcept override { return share_done_; }
  bool input_locked() const noexcept override { return stage_ == Stage::kDither; }
  double locked_output_angle_rad() const noexcept override { return locked_output_rad_; }
  StopReason failed_check() const noexcept override { return failed_; }
  std::vector<NamedRecord> TakeRecords() override;

 private:
  enum class Stage { kBringUp, kDither, kRead };

  bool Dither(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept;

  schedules::SensorCheck parameters_;
  double ratio_;
  double first_Nm_;        // of the dither
  double most_seen_Nm_{};  // by the transducer, of its first periods
  Stage stage_;
  double locked_output_rad_{};
  double planned_s_;
  double share_done_{};
  bool shunted_{};
  double segment_start_s_{};
  StopReason failed_;
  RowLog log_;
};

}  // namespace strainwave::bench
