// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/controller/phase_program.h"
#include "bench/controller/row_log.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// Reads a sensor at standstill, with torque off and brakes on: the torque transducer as it is, without and
/// then with its shunt, or both encoders. Judges nothing; its record says what was to be expected.
/// A torque that is locked in between the brakes counts as one that the transducer shows.
class SensorCheckProgram final : public PhaseProgram {
 public:
  SensorCheckProgram(const schedules::SensorCheck& parameters, double ratio, double period_s);

  void SetUp(const Readings& readings, BenchDevices& devices) override;
  StepResult Step(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept override;
  double timeout_s() const override { return 2.0 * planned_s_ + 30.0; }
  double share_done() const noexcept override { return share_done_; }
  std::vector<NamedRecord> TakeRecords() override;

 private:
  schedules::SensorCheck parameters_;
  double ratio_;
  double planned_s_;
  double share_done_{};
  bool shunted_{};
  double stretch_start_s_{};
  RowLog log_;
};

}  // namespace strainwave::bench
