// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <vector>

#include "bench/controller/motion.h"
#include "bench/controller/phase_program.h"

namespace strainwave::bench {

enum class JogDrive { kDriving, kLoad };

struct JogParameters {
  JogDrive drive{};
  double speed_rad_per_s{};             // at the drive's axis; its sign is the direction
  double acceleration_rad_per_s2{1.0};  // the same
  double period_s{};                    // of the control loop
};

/// Turns one drive as long as a hand holds it, while the other one lets itself be turned (torque zero, brake
/// off). Let go, both have their torque off and their brakes on at once; held again, it starts from rest. It
/// ends on request alone.
class JogProgram final : public PhaseProgram {
 public:
  /// @param held  asked every control period whether the hand is there; returns at once, never throws.
  JogProgram(const JogParameters& parameters, std::function<bool(std::chrono::nanoseconds now)> held);

  void SetUp(const Readings&, BenchDevices&) override {}
  StepResult Step(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept override;
  double timeout_s() const override;
  double share_done() const noexcept override { return 0.0; }
  std::vector<NamedRecord> TakeRecords() override { return {}; }

 private:
  JogParameters parameters_;
  std::function<bool(std::chrono::nanoseconds)> held_;
  Ramp speed_;
  bool raised_{};  // the drives have been told to be enabled
};

}  // namespace strainwave::bench
