// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>

/// Checks of a sensor where what it should read is known: nothing (zero), an electric shunt, a reference mark
/// or weight. Steps of a schedule; pure functions of what was measured.
namespace strainwave::daq::acquisition {

enum class CheckKind { kZero, kShunt, kReference };

/// Unit of the channel.
struct CheckLimits {
  double expected{};
  double allowed{};     // most distance of the mean from `expected`
  double most_noise{};  // most standard deviation of the values: a specimen that still moves is no zero
};

struct CheckResult {
  CheckKind kind{};
  bool passed{};
  double mean{};
  double deviation{};       // standard deviation of the values
  double standard_error{};  // of the mean, values taken as independent
  std::string reason{};     // in words, where it failed
};

/// `values` are the calibrated readings of one check.
CheckResult JudgeCheck(CheckKind kind, std::span<const double> values, const CheckLimits& limits);

struct EarlierCheck {
  double time_days{};  // since any day
  double mean{};
};

/// The straight line through all results so far, oldest first.
struct CheckTrend {
  double slope_per_day{};
  double slope_standard_error{};
  double residual{};  // standard deviation of the results about the line
  /// Days after the last result at which the line meets a limit; nothing if it does not within a hundred
  /// years, or if the slope is not beyond two standard errors, so that it may as well be none.
  std::optional<double> days_left{};
};

/// Nothing with fewer than three results, or all of one day.
std::optional<CheckTrend> TrendOf(std::span<const EarlierCheck> checks, const CheckLimits& limits);

}  // namespace strainwave::daq::acquisition
