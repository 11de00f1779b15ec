// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <span>

namespace strainwave::analysis::reliability {

inline constexpr double kNever = std::numeric_limits<double>::infinity();

/// What is known of one life, in any unit of time (hours, cycles, revolutions): it ended after `lower` and
/// not after `upper`. Equal: a failure at that time. `upper` infinite: suspended at `lower` (right-censored).
/// `lower` zero: failed some time before `upper` (left-censored). Else it lies in an interval.
struct Lifetime {
  double lower{};
  double upper{};
  double count{1.0};  // units that have the same

  static Lifetime Failed(double time) { return {time, time}; }
  static Lifetime Suspended(double time) { return {time, kNever}; }
  static Lifetime FailedBefore(double time) { return {0.0, time}; }
  static Lifetime FailedBetween(double after, double until) { return {after, until}; }

  bool is_exact() const { return lower == upper; }
  bool is_failure() const { return upper != kNever; }
  /// The time of a failure or a suspension; of an interval its middle, of a failure before a time its half.
  double middle() const { return is_failure() ? 0.5 * (lower + upper) : lower; }
};

struct LifetimeCounts {
  double units{};
  double failures{};
};
LifetimeCounts CountLifetimes(std::span<const Lifetime> lifetimes);

/// @throws std::invalid_argument if there is none, a time is negative, zero where a failure or suspension
/// lies, not finite, out of order, or a count is not positive; with the index.
void RequireLifetimes(std::span<const Lifetime> lifetimes);

}  // namespace strainwave::analysis::reliability
