// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace strainwave::analysis::samples {

/// What longer distances than these are gaps, in steps.
inline constexpr double kGap = 3.5;

/// Puts even times in the place of stamps of a clock that ticks more slowly than samples are taken, or that
/// were rounded: each stays within a tick of even samples, between two gaps.
/// @return false where they do not; `time_s` is of no use then.
bool EvenWithinTicks(std::vector<double>& time_s);

/// Stamps that equal the one before.
std::size_t RepeatedStamps(std::span<const double> time_s);

/// Median of |step / median step − 1|.
double StampJitter(std::span<const double> time_s);

/// Samples a second: by the median step, and by the whole way; they differ where stamps are rounded, and
/// where there are gaps. 0 where no time passes.
struct StampRates {
  double by_step_Hz{};
  double by_way_Hz{};
};
StampRates RatesOf(std::span<const double> time_s);

}  // namespace strainwave::analysis::samples
