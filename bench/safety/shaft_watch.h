// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>

#include "bench/roles/sampler.h"
#include "bench/roles/servo_drive.h"
#include "bench/safety/stop_reason.h"

namespace strainwave::bench {

/// Holds the input encoder against the driving servo's own position: both are on one shaft. An encoder of few
/// bits has no noise by which one that stands still is told from one that repeats its last value, and neither
/// has one that slips.
///
/// They may be apart by a degree (coupling, eccentricity of a motor's resolver), two steps of the encoder,
/// and what the shaft turns in the time that lies between the two readings, a bus cycle of each included, at
/// the fastest speed of the last tenth of a second: a shaft that swings stands still where it is farthest
/// from where it was. Longer than a quarter of a second beyond that is a fault. While nothing turns, nothing
/// can be told.
class ShaftWatch {
 public:
  /// @param encoder_step_rad  of the input encoder, not negative.
  explicit ShaftWatch(double encoder_step_rad) noexcept : encoder_step_rad_(encoder_step_rad) {}

  /// From here on, wherever the two stand now.
  void Restart() noexcept { *this = ShaftWatch(encoder_step_rad_); }

  /// Once a control period. Readings of which one is not new, or that lie too far apart in time, are not
  /// judged.
  StopReason Check(const Readings& readings, const DriveActual& driving) noexcept;

 private:
  double encoder_step_rad_;
  std::optional<double> apart_at_start_rad_;
  std::chrono::nanoseconds encoder_time_{};  // of the readings judged last
  std::chrono::nanoseconds drive_time_{};
  double apart_for_s_{};
  double fastest_rad_per_s_{};  // of late
  std::chrono::nanoseconds checked_{};
};

}  // namespace strainwave::bench
