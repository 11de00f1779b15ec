// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "bench/controller/motion.h"
#include "bench/controller/phase_program.h"
#include "bench/controller/row_log.h"
#include "bench/controller/sample_alignment.h"
#include "bench/safety/set_point_watch.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// Lock test: at each lock angle the driving servo turns the wave generator there, its brake is set and its
/// torque taken off; then the load servo ramps 0 → +T → −T → +T → 0 (`loops` times round), holding at each
/// peak. One record an angle: `hysteresis_1`, `hysteresis_2`, …
class HysteresisProgram final : public PhaseProgram {
 public:
  HysteresisProgram(const schedules::HysteresisTest& parameters, const schedules::Specimen& specimen,
                    double period_s);

  void SetUp(const Readings& readings, BenchDevices& devices) override;
  StepResult Step(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept override;
  double timeout_s() const override { return 60.0 + 2.0 * angles() * loop_s(); }
  double share_done() const noexcept override;
  bool input_locked() const noexcept override { return stage_ == Stage::kRamp; }
  double locked_output_angle_rad() const noexcept override { return locked_output_rad_; }
  StopReason failed_check() const noexcept override { return failed_; }
  std::vector<NamedRecord> TakeRecords() override;

 private:
  enum class Stage { kBringUp, kTurnToAngle, kLock, kRamp, kRelease };

  double angles() const { return static_cast<double>(parameters_.lock_angles_rad.size()); }
  double loop_s() const;
  bool Ramped(const Readings& readings) noexcept;
  /// After a peak: what the transducer has seen of it.
  StopReason PeakAway(const Readings& readings) const noexcept;
  bool LogRows(const Readings& readings, double elapsed_s, std::chrono::nanoseconds now) noexcept;
  void BeginAngle(const Readings& readings, const ServoDrive& driving, double elapsed_s) noexcept;

  schedules::HysteresisTest parameters_;
  schedules::Specimen specimen_;
  double period_s_;
  Stage stage_{Stage::kBringUp};
  std::size_t angle_{};
  PointToPoint move_;
  double drive_ahead_rad_{};
  double target_rad_{};  // of the input, where it is locked
  double stage_start_s_{};
  std::chrono::nanoseconds move_ended_{};
  double locked_output_rad_{};
  double loop_start_s_{};
  double next_row_s_{};
  double hold_until_s_{};
  std::vector<double> peaks_Nm_;  // turning points of the torque, in order
  std::size_t peak_{};
  double greatest_Nm_{};  // towards the peak, by the transducer
  std::optional<Ramp> torque_;
  std::optional<SetPointWatch> torque_watch_;
  SampleAlignment alignment_;
  StopReason failed_;
  std::deque<RowLog> logs_;  // one a lock angle
};

}  // namespace strainwave::bench
