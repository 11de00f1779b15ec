// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bench/controller/phase_program.h"

namespace strainwave::bench {

/// Several programs, one after the other, as one phase. Between two of them torque is off and the brakes are
/// on. Every record's name gets `prefix` in front.
class SequenceProgram final : public PhaseProgram {
 public:
  SequenceProgram(std::vector<std::unique_ptr<PhaseProgram>> programs, std::string prefix);

  void SetUp(const Readings& readings, BenchDevices& devices) override;
  StepResult Step(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept override;
  void Collect(BenchDevices& devices) override;
  double control_period_s() const override;
  double timeout_s() const override;
  double share_done() const noexcept override;
  bool input_locked() const noexcept override { return programs_[current_]->input_locked(); }
  double locked_output_angle_rad() const noexcept override {
    return programs_[current_]->locked_output_angle_rad();
  }
  StopReason failed_check() const noexcept override { return programs_[current_]->failed_check(); }
  std::vector<NamedRecord> TakeRecords() override;

 private:
  std::vector<std::unique_ptr<PhaseProgram>> programs_;
  std::string prefix_;
  std::size_t current_{};
  double start_s_{};
  bool set_up_pending_{};
};

}  // namespace strainwave::bench
