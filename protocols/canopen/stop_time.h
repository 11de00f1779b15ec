// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "protocols/cia402.h"

namespace strainwave::protocols::canopen {

/// Measures at commissioning how long a drive takes to stop by itself once the master says nothing any more
/// (DriveMaster::GoSilent, no heartbeat, no SYNC). Samples come from PDOs that the drive sends by event, as
/// those with SYNC cease with it, or the speed from the bench's own encoder.
class StopTimeMeasurement {
 public:
  enum class State : std::uint8_t { kWaiting, kDone, kDidNotStop };

  /// `silent_since` is when the last frame went out. Standing is below `standstill_speed_rad_per_s`, and
  /// remaining there for `still_for`.
  /// @throws std::invalid_argument if a threshold or time is not above zero.
  StopTimeMeasurement(std::chrono::nanoseconds silent_since, double standstill_speed_rad_per_s,
                      std::chrono::nanoseconds still_for, std::chrono::nanoseconds most);

  void OnPower(PowerState power, std::chrono::nanoseconds time) noexcept;
  void OnSpeed(double speed_rad_per_s, std::chrono::nanoseconds time) noexcept;
  State Poll(std::chrono::nanoseconds now) noexcept;

  /// From silence to the first state that is not operation enabled.
  std::optional<std::chrono::nanoseconds> left_enabled_after() const noexcept { return left_enabled_after_; }
  /// From silence to the first sample of the standstill that lasted.
  std::optional<std::chrono::nanoseconds> stood_after() const noexcept { return stood_after_; }

 private:
  std::chrono::nanoseconds silent_since_;
  double standstill_speed_rad_per_s_;
  std::chrono::nanoseconds still_for_;
  std::chrono::nanoseconds most_;
  std::optional<std::chrono::nanoseconds> left_enabled_after_;
  std::optional<std::chrono::nanoseconds> slow_since_;
  std::optional<std::chrono::nanoseconds> stood_after_;
};

}  // namespace strainwave::protocols::canopen
