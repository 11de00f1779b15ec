// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace strainwave::analysis {

/// How the limits of an individuals chart on a slowly trending series are made.
struct ControlChartOptions {
  std::size_t window = 20;   // of the last values, at least 6
  double width = 3.0;        // limits at centre ± width standard deviations, positive
  double sigma_floor = 0.0;  // no narrower than this, e.g. the gauge's repeatability
};

/// Where the next value is expected.
struct ControlLimits {
  double centre{};
  double lower{};
  double upper{};
  double sigma{};  // of one value about the trend

  /// True for NaN as well.
  bool IsOutlier(double value) const { return !(value >= lower && value <= upper); }
};

/// Centre and limits for the next value of a series whose level drifts (docs/requirements.md R39): a line
/// through the last values by Theil and Sen (median of all slopes, median of the offsets), carried on by one;
/// σ from the median moving range about that line, over 0.9539. A few outliers before it move neither. The
/// limits include the line's own error, σ² (1 + 1/n + (x − x̄)²/Sₓₓ), as for least squares.
///
/// @param history  oldest first, one value a cycle; NaN stands for a cycle without a value.
/// @returns none with fewer than 6 values in the window.
/// @throws std::invalid_argument if the options break their rules.
std::optional<ControlLimits> NextValueLimits(std::span<const double> history,
                                             const ControlChartOptions& options = {});

/// Limits of an individuals chart from the first values of a series, which they then stand against for good:
/// mean ± 3 σ, with σ = mean moving range / 1.128, that is mean ± 2.66 mean moving ranges
/// (docs/sources.md#nist-handbook, 6.3.2.2). What wears leaves them, where `NextValueLimits` follows it.
///
/// @param first  oldest first, one value a cycle; NaN stands for a cycle without a value and is passed over.
/// @returns none with fewer than two values.
std::optional<ControlLimits> IndividualsLimits(std::span<const double> first);

}  // namespace strainwave::analysis
