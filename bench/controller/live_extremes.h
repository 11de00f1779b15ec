// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <limits>

#include "bench/roles/sampler.h"

namespace strainwave::bench {

/// Smallest, largest and last of some values; nothing that is no number counts.
struct Extremes {
  double min{std::numeric_limits<double>::infinity()};
  double max{-std::numeric_limits<double>::infinity()};
  double last{std::numeric_limits<double>::quiet_NaN()};

  bool empty() const noexcept { return !(min <= max); }
  void Add(double value) noexcept {
    if (!std::isfinite(value)) return;
    if (value < min) min = value;
    if (value > max) max = value;
    last = value;
  }
  void Merge(const Extremes& later) noexcept {
    if (later.empty()) return;
    if (later.min < min) min = later.min;
    if (later.max > max) max = later.max;
    last = later.last;
  }

  bool operator==(const Extremes&) const = default;
};

/// The channels that people watch while the bench runs.
inline constexpr std::array kLiveChannels{Channel::kOutputTorque, Channel::kInputSpeed,
                                          Channel::kGearTemperature, Channel::kVibrationRms};

/// Extremes of each of `kLiveChannels` over some readings, in the units of `Readings`. A channel that is bad
/// in a reading has no value there.
struct LiveExtremes {
  std::array<Extremes, kLiveChannels.size()> channels{};
  std::chrono::nanoseconds newest{};  // time of the newest of the readings

  bool empty() const noexcept {
    for (const Extremes& channel : channels) {
      if (!channel.empty()) return false;
    }
    return true;
  }
  void Add(const Readings& readings) noexcept {
    const std::array values{readings.output_torque_Nm, readings.input_speed_rad_per_s,
                            readings.gear_temperature_degC, readings.vibration_rms_m_per_s2};
    static_assert(values.size() == kLiveChannels.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      if ((readings.bad_channels & (1u << static_cast<unsigned>(kLiveChannels[i]))) != 0) continue;
      channels[i].Add(values[i]);
    }
    newest = readings.time;
  }
  void Merge(const LiveExtremes& later) noexcept {
    for (std::size_t i = 0; i < channels.size(); ++i) channels[i].Merge(later.channels[i]);
    if (later.newest > newest) newest = later.newest;  // of no readings it is none
  }
};

}  // namespace strainwave::bench
