// SPDX-License-Identifier: Apache-2.0
#include "bench/safety/shaft_watch.h"

#include <algorithm>
#include <cmath>

#include "analysis/units.h"
#include "bench/seconds.h"

namespace strainwave::bench {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr double kPlay_rad = RadFromDeg(1.0);
constexpr double kSteps = 2.0;
// A drive tells where it was at the last SYNC, an encoder's sample waits for
// its block.
constexpr double kBusCycles_s = 0.02;
constexpr nanoseconds kMostBetween = milliseconds(50);
constexpr double kApartFor_s = 0.25;
// A shaft that swings is fastest once in half a period; what swings on a gear
// or in a drive's loop does so at 5 Hz and more (14 Hz seen on a simulated
// drive behind a slow line).
constexpr double kDecay_s = 0.1;

}  // namespace

StopReason ShaftWatch::Check(const Readings& readings, const DriveActual& driving) noexcept {
  fastest_rad_per_s_ =
      std::max({std::abs(driving.speed_rad_per_s), std::abs(readings.input_speed_rad_per_s),
                fastest_rad_per_s_ * std::exp(Seconds(checked_ - readings.time) / kDecay_s)});
  checked_ = readings.time;
  const nanoseconds between = std::chrono::abs(readings.input_angle_time - driving.time);
  const bool is_new = readings.input_angle_time > encoder_time_ && driving.time > drive_time_;
  if (!driving.tells_position || !is_new || between > kMostBetween) return {};
  const nanoseconds since = std::min(driving.time - drive_time_, kMostBetween);
  encoder_time_ = readings.input_angle_time;
  drive_time_ = driving.time;
  const double apart_now_rad = readings.input_angle_rad - driving.position_rad;
  if (!apart_at_start_rad_) apart_at_start_rad_ = apart_now_rad;
  const double apart_rad = apart_now_rad - *apart_at_start_rad_;
  const double turned_between_rad = fastest_rad_per_s_ * (Seconds(between) + kBusCycles_s);
  const double most_rad = kPlay_rad + kSteps * encoder_step_rad_ + turned_between_rad;
  apart_for_s_ = std::abs(apart_rad) > most_rad ? apart_for_s_ + Seconds(since) : 0.0;
  if (apart_for_s_ < kApartFor_s) return {};
  return {StopCause::kInputAngleApart, apart_rad, most_rad, readings.time};
}

}  // namespace strainwave::bench
