// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "bench/controller/phase_program.h"
#include "bench/trip_test/trip_row.h"

namespace strainwave::bench {

/// What the bench does when a condition is brought about.
enum class TripMotion {
  kStandstill,  // torque off, brakes on
  kComingUp,    // before the drives are told to be enabled
  kTurning,     // a load run, slow and under little load
  kLocked,      // a lock test: the input held by its brake, torque from the load servo
};

/// At that moment.
struct ProvokedState {
  Readings readings;
  double twist_rad{};  // since the input was locked
};

/// The phase of a schedule that a motion is, gentle: at most 300 rpm and a quarter of the rated torque, and
/// never above a third of the limit of the speed or half of that of the torque.
std::unique_ptr<PhaseProgram> MakeMotion(TripMotion motion, const TripSettings& settings, double period_s);

/// A phase in whose course a condition is brought about: once, when it has gone steadily for a while. What
/// the phase does, and what the runner watches around it, is as in a campaign.
class ProvokedProgram final : public PhaseProgram {
 public:
  /// @param provoke  called once, in the control loop; must not throw after the drives were told to be
  ///   enabled.
  /// @param wait_s   after that; then the phase is done.
  ProvokedProgram(std::unique_ptr<PhaseProgram> phase, TripMotion motion, double wait_s,
                  std::function<void(const ProvokedState&)> provoke);

  void SetUp(const Readings& readings, BenchDevices& devices) override;
  StepResult Step(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept override;
  void Collect(BenchDevices& devices) override { phase_->Collect(devices); }
  double control_period_s() const override { return phase_->control_period_s(); }
  double timeout_s() const override { return phase_->timeout_s(); }
  double share_done() const noexcept override { return 0.0; }
  bool input_locked() const noexcept override { return phase_->input_locked(); }
  double locked_output_angle_rad() const noexcept override { return phase_->locked_output_angle_rad(); }
  StopReason failed_check() const noexcept override { return phase_->failed_check(); }
  std::vector<NamedRecord> TakeRecords() override { return {}; }

 private:
  bool IsSteady(const BenchDevices& devices) const noexcept;
  void ProvokeNow(const Readings& readings, double elapsed_s);

  std::unique_ptr<PhaseProgram> phase_;
  TripMotion motion_;
  double wait_s_;
  std::function<void(const ProvokedState&)> provoke_;
  std::optional<double> steady_since_s_;
  std::optional<double> provoked_at_s_;
};

}  // namespace strainwave::bench
