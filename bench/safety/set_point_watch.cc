// SPDX-License-Identifier: Apache-2.0
#include "bench/safety/set_point_watch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/units.h"

namespace strainwave::bench {
namespace {

constexpr double kLowPass_s = 0.1;
// What is near a set point that moves says little: a servo at its limit is, for most of a ramp from one sign
// to the other. A tenth of such time counts against what was away.
constexpr double kOnTheWay = 0.1;
// Of the encoder's speed: the times of two samples are known to milliseconds, which of ten are a third.
constexpr double kSpeedWindow_s = 0.1;

}  // namespace

void SetPointWatch::Step(double set_point, double measured, std::chrono::nanoseconds sampled,
                         double period_s) noexcept {
  if (!set_point_) {
    set_point_ = set_point;
    measured_ = measured;
  }
  const double moved_per_s = std::abs(set_point - *set_point_) / period_s;
  set_point_ = set_point;
  stood_for_s_ = moved_per_s > 0.0 ? 0.0 : stood_for_s_ + period_s;
  fastest_per_s_ = settled() ? 0.0 : std::max(fastest_per_s_, moved_per_s);
  since_sample_s_ += period_s;
  if (sampled_ && sampled <= *sampled_) return;
  sampled_ = sampled;
  const double since_s = std::exchange(since_sample_s_, 0.0);
  measured_ += (measured - measured_) * std::min(1.0, since_s / kLowPass_s);
  const double most = tolerance_ + fastest_per_s_ * schedules::kSettlesWithin_s;
  away_ = !(std::abs(measured_ - set_point) <= most);  // also where nothing is measured
  away_s_ = away_ ? away_s_ + since_s : std::max(0.0, away_s_ - (settled() ? 1.0 : kOnTheWay) * since_s);
}

bool SetPointWatch::settled() const noexcept { return stood_for_s_ >= schedules::kSettlesWithin_s; }

double TorqueTolerance_Nm(const schedules::SetPointTolerances& tolerances, double output_torque_Nm,
                          const schedules::Specimen& specimen) noexcept {
  return tolerances.torque_share * std::max(std::abs(output_torque_Nm), specimen.rated_torque_Nm / 3.0);
}

LoadWatch::LoadWatch(const schedules::SetPointTolerances& tolerances, double output_torque_Nm,
                     double input_speed_rad_per_s, const schedules::Specimen& specimen) noexcept
    : torque_(TorqueTolerance_Nm(tolerances, output_torque_Nm, specimen), tolerances.dwell_s),
      speed_(tolerances.speed_share * input_speed_rad_per_s, tolerances.dwell_s) {}

void LoadWatch::Step(double output_torque_Nm, double input_speed_rad_per_s, const Readings& readings,
                     double period_s) noexcept {
  // Between two samples of the encoder the speed stays what it was.
  if (encoder_time_ && readings.input_angle_time > *encoder_time_) {
    const std::chrono::duration<double> apart = readings.input_angle_time - *encoder_time_;
    const double kept = std::exp(-apart.count() / kSpeedWindow_s);
    turned_rad_ = kept * turned_rad_ + readings.input_angle_rad - encoder_angle_rad_;
    turned_s_ = kept * turned_s_ + apart.count();
  }
  if (!encoder_time_ || readings.input_angle_time > *encoder_time_) {
    encoder_time_ = readings.input_angle_time;
    encoder_angle_rad_ = readings.input_angle_rad;
  }
  torque_.Step(output_torque_Nm, readings.output_torque_Nm, readings.torque_time, period_s);
  speed_.Step(input_speed_rad_per_s, this->input_speed_rad_per_s(), readings.input_angle_time, period_s);
  time_ = readings.time;
  if (torque_.is_away_for_too_long()) {
    failed_ = TorqueReason();
  } else if (speed_.is_away_for_too_long()) {
    failed_ = SpeedReason();
  }
}

StopReason LoadWatch::TorqueReason() const noexcept {
  return {StopCause::kTorqueAway, torque_.measured(), torque_.set_point(), time_, BenchServo::kLoad};
}

StopReason LoadWatch::SpeedReason() const noexcept {
  return {StopCause::kSpeedAway, speed_.measured(), speed_.set_point(), time_, BenchServo::kDriving};
}

StopReason LoadWatch::away_reason() const noexcept {
  if (torque_.away()) return TorqueReason();
  return speed_.away() ? SpeedReason() : StopReason{};
}

StopReason PositionAway(double sent_to_rad, const Readings& readings) noexcept {
  constexpr double kMost_rad = kTwoPi / 4.0;
  const double away_rad = readings.input_angle_rad - sent_to_rad;
  if (std::abs(away_rad) <= kMost_rad) return {};
  return {StopCause::kPositionAway, away_rad, kMost_rad, readings.time, BenchServo::kDriving};
}

}  // namespace strainwave::bench
