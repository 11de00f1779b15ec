// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

/// Time between two channels that should be captured at once, measured and taken out: at 1000 rpm at the
/// input of a 1:80 reducer, 1 ms between its two encoders reads as 4.5 arcmin of transmission error.
namespace strainwave::daq::acquisition {

struct Skew {
  double skew_s{};  // the second channel shows the same moment this much later
  double standard_error_s{};
};

/// From a signal that both see, such as one shaft on two encoders: the lag with the highest correlation, then
/// the fraction of a sample by least squares (delay, gain and offset of the second against the first). Both
/// at one rate, with their content below a tenth of it. Nothing where the signals do not move, hold a value
/// that is not finite, or the best lag is the longest one tried.
/// @throws std::invalid_argument if the lengths differ, or are not four times the longest lag.
std::optional<Skew> SkewByCorrelation(std::span<const double> first, std::span<const double> second,
                                      double rate_hz, double longest_skew_s);

/// From the difference of two angles (`second` minus `first`, same shaft side) at several speeds: a skew
/// shows as difference = -speed * skew + constant, with the sign turning with the direction; an eccentricity
/// does not. Nothing with fewer than three rows or one speed only.
/// @throws std::invalid_argument if the lengths differ.
std::optional<Skew> SkewByRegression(std::span<const double> speed_rad_per_s,
                                     std::span<const double> difference_rad);

/// What the channel would have shown `shift_s` later, on the same time base: cubic interpolation through four
/// samples. To take out a skew, shift the second channel by it. NaN at the ends where there is nothing to
/// interpolate between.
std::vector<double> ShiftInTime(std::span<const double> values, double rate_hz, double shift_s);

/// A channel with its own times (rising) read at other times, by the same interpolation; NaN outside.
/// @throws std::invalid_argument if the lengths differ, or times do not rise.
std::vector<double> OnTimeBase(std::span<const double> times_s, std::span<const double> values,
                               std::span<const double> wanted_s);

}  // namespace strainwave::daq::acquisition
