// SPDX-License-Identifier: Apache-2.0
#include "bench/safety/drive_watch.h"

#include <algorithm>

#include "bench/seconds.h"

namespace strainwave::bench {
namespace {

using protocols::PowerState;
using std::chrono::nanoseconds;

}  // namespace

void DriveWatch::Enable(DriveMode mode) noexcept {
  asked_ = Asked::kToComeUp;
  way_up_begin_ = std::nullopt;
  drive_.Enable(mode);
}

void DriveWatch::Disable() noexcept {
  asked_ = Asked::kNothing;
  drive_.Disable();
}

void DriveWatch::QuickStop() noexcept {
  asked_ = Asked::kNothing;
  brake_released_ = false;
  drive_.QuickStop();
}

void DriveWatch::SetBrake(bool engaged) noexcept {
  brake_released_ = !engaged;
  drive_.SetBrake(engaged);
}

void DriveWatch::Restart(nanoseconds now) noexcept { restarted_ = now; }

StopReason DriveWatch::Check(const DriveActual& actual, nanoseconds now,
                             nanoseconds longest_silence) noexcept {
  const auto reason = [&](StopCause cause, nanoseconds value, nanoseconds limit) {
    return StopReason{cause, Seconds(value), Seconds(limit), now, servo_};
  };
  const nanoseconds age = now - std::max(actual.time, restarted_);
  if (age > longest_silence) return reason(StopCause::kDriveSilent, age, longest_silence);
  if (asked_ == Asked::kNothing) return {};
  const bool enabled = actual.power == PowerState::kOperationEnabled;
  if (asked_ == Asked::kToComeUp) {
    if (!way_up_begin_) way_up_begin_ = now;
    if (enabled && !actual.brake_engaged) {
      asked_ = Asked::kToStayUp;
      return {};
    }
    if (now - *way_up_begin_ <= kLongestWayUp) return {};
    return reason(StopCause::kDriveNotReady, now - *way_up_begin_, kLongestWayUp);
  }
  if (!enabled) return reason(StopCause::kDriveDroppedOut, {}, {});
  if (!brake_released_ || !actual.brake_engaged) {
    brake_seen_on_ = std::nullopt;
    return {};
  }
  // A drive that drops out engages its brake, and may tell that first.
  if (!brake_seen_on_) brake_seen_on_ = actual.time;
  return actual.time > *brake_seen_on_ ? reason(StopCause::kBrakeEngaged, {}, {}) : StopReason{};
}

}  // namespace strainwave::bench
