// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/controller/motion.h"
#include "bench/controller/phase_program.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// Before the first load on a bench of metal: turns the input slowly under a small torque of either sign, and
/// holds transducer and encoder against what the servos were asked for. A factor or a sign that is off, of a
/// register, a reducer, a calibration or an encoder, shows here at half of T1 and not at the first load.
///
/// The torque's factor is the change of the transducer over the change of the set point between its two
/// signs, in which zero and friction of a shaft that turns one way cancel; the speed's is the encoder's way
/// over that asked for.
class LoadCheckProgram final : public PhaseProgram {
 public:
  LoadCheckProgram(const schedules::Specimen& specimen, double period_s);

  void SetUp(const Readings& readings, BenchDevices& devices) override;
  StepResult Step(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept override;
  double timeout_s() const override { return 60.0; }
  double share_done() const noexcept override { return 0.0; }
  StopReason failed_check() const noexcept override { return failed_; }
  std::vector<NamedRecord> TakeRecords() override { return {}; }

  /// Measured over asked for; meaningless before the program is done.
  double torque_factor() const noexcept { return torque_factor_; }
  double speed_factor() const noexcept { return speed_factor_; }

 private:
  enum class Stage { kBringUp, kSpeedUp, kPositive, kNegative, kUnload, kReturn };

  bool Judge(const Readings& readings) noexcept;
  StepResult Hold(const Readings& readings, double elapsed_s, Stage next, double& mean_Nm) noexcept;

  double torque_Nm_;
  double period_s_;
  Stage stage_{Stage::kBringUp};
  double stage_start_s_{};
  Ramp speed_;
  Ramp torque_;
  double start_rad_{};  // of the input
  double rest_Nm_{};    // by the transducer, without torque
  double turned_from_rad_{};
  double asked_rad_{};  // since then
  double sum_Nm_{};
  int count_{};
  double positive_Nm_{};
  double negative_Nm_{};
  double torque_factor_{};
  double speed_factor_{};
  StopReason failed_;
};

}  // namespace strainwave::bench
