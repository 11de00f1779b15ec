// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/controller/phase_program.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// Checks at standstill, with torque off and brakes on, before anything moves (docs/requirements.md R10 and
/// R12): every channel fresh and plausible, torque near zero, encoders at rest, and, after a pause, both
/// encoders where the journal says they were.
class ReferencingProgram final : public PhaseProgram {
 public:
  struct Tolerances {
    double torque_zero_Nm{};
    double angle_rad{};  // of the output
  };
  /// @param expected_offset_rad  input angle / ratio − output angle when the bench last stood, or a NaN when
  ///   nothing is known of it.
  ReferencingProgram(const Tolerances& tolerances, double ratio, double expected_offset_rad);

  void SetUp(const Readings& readings, BenchDevices& devices) override;
  StepResult Step(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept override;
  double timeout_s() const override { return 30.0; }
  double share_done() const noexcept override { return 0.0; }
  StopReason failed_check() const noexcept override { return failed_; }
  std::vector<NamedRecord> TakeRecords() override { return {}; }

 private:
  Tolerances tolerances_;
  double ratio_;
  double expected_offset_rad_;
  double torque_sum_Nm_{};
  int count_{};
  StopReason failed_;
};

/// Waits at standstill until the gear is cool enough, or the time is over.
class SoakProgram final : public PhaseProgram {
 public:
  explicit SoakProgram(const schedules::Soak& parameters) : parameters_(parameters) {}

  void SetUp(const Readings&, BenchDevices&) override {}
  StepResult Step(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept override;
  double timeout_s() const override { return parameters_.at_most_s + 60.0; }
  double share_done() const noexcept override { return share_done_; }
  std::vector<NamedRecord> TakeRecords() override { return {}; }

 private:
  schedules::Soak parameters_;
  double share_done_{};
};

}  // namespace strainwave::bench
