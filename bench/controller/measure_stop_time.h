// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <functional>
#include <optional>

#include "bench/controller/phase_runner.h"

namespace strainwave::bench {

struct StopTimeParameters {
  double input_speed_rad_per_s{};
  double input_acceleration_rad_per_s2{};
  double period_s{};
  double stale_after_s{};
  schedules::Limits limits;  // on the way up
  /// Below it a shaft stands: of the motor's shaft, and of the output.
  std::array<double, 2> standstill_rad_per_s{};
  std::chrono::nanoseconds most{
      std::chrono::seconds(5)};  // after it a drive counts as one that does not stop
};

/// Of one drive, from the last that was sent to it.
struct StopTime {
  std::optional<std::chrono::nanoseconds> left_enabled_after;  // by its own statusword
  std::optional<std::chrono::nanoseconds> stood_after;         // its shaft, by the bench's encoder
};

struct StopTimes {
  StopReason ended_before;           // why there was nothing to measure; none: it was measured
  std::array<StopTime, 2> drives{};  // driving, load
};

/// How long the drives take to stop when this program is gone (docs/requirements.md R14): turns the input
/// with the load's torque at zero, then `go_silent` must see to it that nothing more is sent, and the shafts
/// are watched. The drives get their quick stop on every way out; they must be set up anew afterwards.
StopTimes MeasureStopTimes(BenchDevices devices, const StopTimeParameters& parameters,
                           const std::function<void()>& go_silent, const std::atomic<StopRequest>& request);

}  // namespace strainwave::bench
