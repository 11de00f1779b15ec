// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>

#include "bench/roles/sampler.h"
#include "bench/safety/stop_reason.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// Holds what is measured to the set point that a servo was given.
///
/// What is measured, low-passed with 0.1 s (a strain-wave gear's torque ripples twice an input turn), may be
/// away from the set point by a tolerance, and, while the set point moves and 0.4 s after that
/// (schedules::kSettlesWithin_s), by what it moves in 0.4 s besides.
class SetPointWatch {
 public:
  /// @param tolerance  in the unit of the set point, above zero.
  /// @param dwell_s    how long it may be away, together; time within the tolerance of a set point that
  ///   stands counts against it.
  SetPointWatch(double tolerance, double dwell_s) noexcept : tolerance_(tolerance), dwell_s_(dwell_s) {}

  /// Once a control period, with the set point that was last given. A sample counts once: between two of
  /// them (`sampled` as before) nothing is known of where the servo is.
  void Step(double set_point, double measured, std::chrono::nanoseconds sampled, double period_s) noexcept;

  /// The set point has stood long enough for the servo to have reached it.
  bool settled() const noexcept;
  bool away() const noexcept { return away_; }
  bool is_away_for_too_long() const noexcept { return away_s_ > dwell_s_; }
  double measured() const noexcept { return measured_; }  // low-passed
  double set_point() const noexcept { return set_point_.value_or(0.0); }

 private:
  double tolerance_;
  double dwell_s_;
  std::optional<double> set_point_;
  std::optional<std::chrono::nanoseconds> sampled_;
  double since_sample_s_{};
  double measured_{};
  double fastest_per_s_{};  // of the set point's moves that still count
  double stood_for_s_{};
  double away_s_{};
  bool away_{};
};

/// How far the output torque may be from `output_torque_Nm`. Of a small torque a share is less than what
/// friction behind the load servo takes, so that it is at least that share of a third of the rated torque.
double TorqueTolerance_Nm(const schedules::SetPointTolerances& tolerances, double output_torque_Nm,
                          const schedules::Specimen& specimen) noexcept;

/// The load of a phase that turns the input at constant speed under constant output torque, by transducer and
/// input encoder, whatever the drives say of themselves.
class LoadWatch {
 public:
  LoadWatch(const schedules::SetPointTolerances& tolerances, double output_torque_Nm,
            double input_speed_rad_per_s, const schedules::Specimen& specimen) noexcept;

  /// Once a control period, with the set points that were last given.
  void Step(double output_torque_Nm, double input_speed_rad_per_s, const Readings& readings,
            double period_s) noexcept;

  /// Both set points stand, and the servos had the time to reach them.
  bool settled() const noexcept { return torque_.settled() && speed_.settled(); }
  bool away() const noexcept { return torque_.away() || speed_.away(); }
  /// Which servo is away now; none where none is.
  StopReason away_reason() const noexcept;
  /// Away for longer than the dwell, and which servo; none where not.
  StopReason failed() const noexcept { return failed_; }
  /// By the encoder, of about the last tenth of a second.
  double input_speed_rad_per_s() const noexcept { return turned_s_ > 0.0 ? turned_rad_ / turned_s_ : 0.0; }

 private:
  StopReason TorqueReason() const noexcept;
  StopReason SpeedReason() const noexcept;

  SetPointWatch torque_;
  SetPointWatch speed_;
  std::optional<std::chrono::nanoseconds> encoder_time_;
  double encoder_angle_rad_{};
  double turned_rad_{}, turned_s_{};  // the older, the less they weigh
  std::chrono::nanoseconds time_{};   // of the readings
  StopReason failed_;
};

/// A quarter turn of the input is 1.1 degrees of the output at 1:80: a servo that is further from where it
/// was sent when a measurement begins there has not followed.
StopReason PositionAway(double sent_to_rad, const Readings& readings) noexcept;

}  // namespace strainwave::bench
