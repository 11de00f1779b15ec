// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/controller/phase_program.h"

namespace strainwave::bench {

/// Lets go of a gear that was braked under load and stands wound up between its two brakes: the load servo's
/// brake is released at a torque of zero, while the input's stays on. The output turns back by the gear's own
/// wind-up, a fraction of a degree. Done when the transducer shows next to nothing, or after a time in which
/// every gear has unwound; whether what is left is too much is for the references to say.
class UnwindProgram final : public PhaseProgram {
 public:
  /// @param torque_zero_Nm  what the references allow at rest
  explicit UnwindProgram(double torque_zero_Nm) : torque_zero_Nm_(torque_zero_Nm) {}

  void SetUp(const Readings& readings, BenchDevices& devices) override;
  StepResult Step(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept override;
  double timeout_s() const override { return 30.0; }
  double share_done() const noexcept override { return 0.0; }
  StopReason failed_check() const noexcept override { return failed_; }
  std::vector<NamedRecord> TakeRecords() override { return {}; }

 private:
  double torque_zero_Nm_;
  double start_output_rad_{};
  double released_s_{-1.0};  // elapsed when the brake was off; negative before
  double small_since_s_{};
  StopReason failed_;
};

}  // namespace strainwave::bench
