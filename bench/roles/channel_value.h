// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <limits>

namespace strainwave::bench {

/// The newest value of a slow channel, in the channel's unit, and when it was true on the clock of
/// `BenchClock`. Only a good one is a value: fresh, plausible and received without an error.
struct ChannelValue {
  double value{std::numeric_limits<double>::quiet_NaN()};
  std::chrono::nanoseconds time{};
  bool good{};
  /// When the sample was taken, as near as the device's clock lets it be known; zero: `time` is all there is.
  std::chrono::nanoseconds sampled{};
};

}  // namespace strainwave::bench
