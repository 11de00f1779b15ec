// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

#include "bench/controller/motion.h"
#include "bench/controller/phase_program.h"
#include "bench/controller/row_log.h"
#include "bench/controller/vibration_statistics.h"
#include "bench/safety/set_point_watch.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// Turns the output clockwise and back at constant input speed while the load servo brakes it with constant
/// torque, until the load time is served; then parks where measurements begin. What an earlier attempt has
/// served already is given as `credited_s` and not run again.
///
/// Load is credited while transducer and encoder are within the phase's tolerances of what is asked for. What
/// a ramp or a reversal takes counts when the load that it leads to is there, and not before. Beside the time
/// stands the equivalent load time: time at the load asked for that would wear the wave-generator bearing as
/// what was measured does (Miner with the cube of the torque times the speed, analysis/bearing_life.h).
class LoadRunProgram final : public PhaseProgram {
 public:
  LoadRunProgram(const schedules::LoadRun& parameters, const schedules::Specimen& specimen, double credited_s,
                 double period_s);

  void SetUp(const Readings& readings, BenchDevices& devices) override;
  StepResult Step(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept override;
  void Collect(BenchDevices& devices) override;
  bool WindDown() noexcept override {
    winding_down_ = true;
    return true;
  }
  double timeout_s() const override { return 1.2 * parameters_.duration_s + 60.0; }
  double share_done() const noexcept override { return credited_s_ / parameters_.duration_s; }
  StopReason failed_check() const noexcept override { return watch_.failed(); }
  double credited_load_s() const noexcept override { return credited_s_; }
  std::vector<NamedRecord> TakeRecords() override { return RecordsSoFar(); }
  std::vector<NamedRecord> RecordsSoFar() const override;

 private:
  // Of the readings between two rows of the log.
  struct Interval {
    int count{};
    double torque_sum_Nm{};
    double torque_min_Nm{};
    double torque_max_Nm{};
    double motor_torque_sum_Nm{};
    double vibration_square_sum{};
    double temperature_degC{};
    double ambient_degC{};
    double speed_max_rad_per_s{};
  };
  // Load time, and the equivalent of it.
  struct Load {
    double time_s{};
    double equivalent_s{};
  };
  StepResult WindDownStep(const Readings& readings, BenchDevices& devices) noexcept;
  void Credit(const Readings& readings) noexcept;
  void Commit() noexcept;
  bool Log(const Readings& readings, double elapsed_s) noexcept;

  schedules::LoadRun parameters_;
  double ratio_;
  double turn_input_rad_;
  double way_s_;  // one way and the time to settle: longer than a load that stands is away from the next
  double period_s_;
  std::atomic<double> credited_s_;  // written by the phase alone
  double direction_{1.0};
  double turn_start_rad_{};
  double next_row_s_{};
  bool under_load_{};
  bool winding_down_{};
  double oldest_angles_s_{};  // since then: a stream's block
  bool parking_{};
  double home_input_rad_{};
  Ramp speed_;
  Ramp torque_;
  LoadWatch watch_;
  Load on_the_way_;        // served, and credited when the load that it leads to is there
  double equivalent_s_{};  // of what this attempt has been credited
  Interval interval_;
  VibrationStatistics statistics_;
  RowLog log_;
};

}  // namespace strainwave::bench
