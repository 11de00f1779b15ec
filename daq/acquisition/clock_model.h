// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

namespace strainwave::daq::acquisition {

/// Where a device's clock stands against the monotonic clock of this machine.
struct ClockEstimate {
  std::chrono::nanoseconds device_time{};  // a moment by the device's clock ...
  std::chrono::nanoseconds host_time{};    // ... and the same by the monotonic clock
  double drift{};                          // host seconds a device second, minus one
  double offset_uncertainty_s{};           // of `host_time`, within the span of the pairs, 95 %
  double drift_uncertainty{};              // 95 %
  std::size_t pairs{};                     // that it rests on

  std::chrono::nanoseconds ToHost(std::chrono::nanoseconds device) const noexcept;
};

struct ClockModelSettings {
  /// Of each segment so long by the device's clock the pair that came with the least delay is kept.
  std::chrono::nanoseconds segment{std::chrono::milliseconds(250)};
  /// Segments that are kept. Clocks wander with the temperature: a minute is a straight line, an hour is
  /// not.
  std::size_t most_segments{240};
  /// What even the fastest delivery takes, such as the device's filter. Nothing in the pairs shows it.
  std::chrono::nanoseconds least_delay{};
  /// A pair further off than this from where the others say it should be is a clock that was set anew.
  std::chrono::nanoseconds longest_delay{std::chrono::seconds(2)};
};

/// Estimates offset and drift of a device's clock as pairs come in: the device's time of a sample and the
/// monotonic time at which that sample was here. A delivery can be late, by milliseconds over USB and more
/// over a network, but never early; so the line sought lies below all pairs, as near to them as it can (the
/// linear program of Moon, Skelly and Towsley, INFOCOM 1999), and one quick delivery now and then is enough.
///
/// The constant part of the delay stays in the offset: it shows in no pair. Where two devices must agree to
/// microseconds, that rest is measured with a common signal (`channel_skew.h`).
/// Both times are intervals of steady clocks; the time of day does not enter.
class ClockModel {
 public:
  /// @throws std::invalid_argument for a segment that is not above zero or fewer than two of them.
  explicit ClockModel(ClockModelSettings settings);

  /// One pair, in the order of the device's time. Takes no memory. A device's clock that steps, back or by
  /// more than `longest_delay`, starts the model anew, which `restarts()` counts.
  void Add(std::chrono::nanoseconds device_time, std::chrono::nanoseconds arrival) noexcept;

  /// Nothing before two segments are over.
  const std::optional<ClockEstimate>& estimate() const { return estimate_; }
  std::uint64_t restarts() const { return restarts_; }

 private:
  struct Pair {
    std::int64_t device_ns;
    std::int64_t delay_ns;  // arrival minus device time: offset, drift and delay together
  };
  double DelayAbove(const Pair& pair) const noexcept;
  void CloseSegment() noexcept;
  void Fit() noexcept;

  ClockModelSettings settings_;
  std::vector<Pair> kept_;     // a ring: the quickest of each segment
  std::vector<Pair> ordered_;  // of it, oldest first
  std::vector<Pair> hull_;
  std::vector<double> above_;
  std::size_t next_{};
  std::size_t count_{};
  std::uint64_t pairs_{};
  std::optional<Pair> quickest_;  // of the segment that runs
  std::optional<Pair> last_;
  std::int64_t segment_begin_ns_{};
  std::optional<ClockEstimate> estimate_;
  std::uint64_t restarts_{};
};

}  // namespace strainwave::daq::acquisition
