// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string>

namespace strainwave::bench {

/// Counts durations from a cyclic thread: bins a sixteenth of their power of two wide, so that a percentile
/// is off by at most 6 % and memory is fixed. Negative durations count as zero.
class TimingHistogram {
 public:
  void Add(std::chrono::nanoseconds duration) noexcept;

  std::uint64_t count() const noexcept { return count_; }
  std::chrono::nanoseconds longest() const noexcept { return longest_; }
  /// The smallest bin's upper end that `share` (0 to 1) of the durations do not exceed; never above the
  /// longest one. Zero when nothing was counted.
  std::chrono::nanoseconds Percentile(double share) const noexcept;
  /// "p50 1.00 ms, p99 1.02 ms, p99.9 1.05 ms, max 1.21 ms of 600000".
  std::string Text() const;

 private:
  static constexpr int kSteps = 16;   // a power of two
  static constexpr int kPowers = 40;  // of nanoseconds: 18 minutes
  static std::size_t BinOf(std::uint64_t nanoseconds) noexcept;
  static std::uint64_t EndOf(std::size_t bin) noexcept;

  std::array<std::uint64_t, kSteps * kPowers> bins_{};
  std::uint64_t count_{};
  std::chrono::nanoseconds longest_{};
};

}  // namespace strainwave::bench
