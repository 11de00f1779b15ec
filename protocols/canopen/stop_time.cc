// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/stop_time.h"

#include <cmath>
#include <stdexcept>

namespace strainwave::protocols::canopen {

using std::chrono::nanoseconds;

StopTimeMeasurement::StopTimeMeasurement(nanoseconds silent_since, double standstill_speed_rad_per_s,
                                         nanoseconds still_for, nanoseconds most)
    : silent_since_(silent_since),
      standstill_speed_rad_per_s_(standstill_speed_rad_per_s),
      still_for_(still_for),
      most_(most) {
  if (!(standstill_speed_rad_per_s > 0.0) || still_for <= nanoseconds::zero() ||
      most <= nanoseconds::zero()) {
    throw std::invalid_argument("standstill_speed_rad_per_s, still_for and most are not all above zero");
  }
}

void StopTimeMeasurement::OnPower(PowerState power, nanoseconds time) noexcept {
  if (!left_enabled_after_ && time >= silent_since_ && power != PowerState::kOperationEnabled) {
    left_enabled_after_ = time - silent_since_;
  }
}

void StopTimeMeasurement::OnSpeed(double speed_rad_per_s, nanoseconds time) noexcept {
  if (stood_after_ || time < silent_since_) return;
  // Not-a-number is no standstill.
  if (!(std::abs(speed_rad_per_s) < standstill_speed_rad_per_s_)) {
    slow_since_.reset();
    return;
  }
  if (!slow_since_) slow_since_ = time;
  if (time - *slow_since_ >= still_for_) stood_after_ = *slow_since_ - silent_since_;
}

StopTimeMeasurement::State StopTimeMeasurement::Poll(nanoseconds now) noexcept {
  if (left_enabled_after_ && stood_after_) return State::kDone;
  return now - silent_since_ >= most_ ? State::kDidNotStop : State::kWaiting;
}

}  // namespace strainwave::protocols::canopen
