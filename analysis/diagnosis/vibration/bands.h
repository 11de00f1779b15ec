// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "analysis/diagnosis/vibration/starts.h"

namespace strainwave::analysis::diagnosis {

/// A band of the spectrum over time that is stronger than its surroundings, the channels in step or against
/// each other.
struct NoiseBand {
  double excess{};  // −ln p without the trials factor
  double centre_Hz{};
  double width_Hz{};
  /// A channel of all runs: deviation of what moves it in that of its noise, signed.
  std::vector<double> sizes;
};

/// The strongest bands in order, none wider than 0.7 of its frequency, none within another, none whose
/// power is mostly that of one tone. A mode moves all channels of a record in one proportion, so what they
/// hold along the best one is what counts: noise has no such direction.
std::vector<NoiseBand> FindBands(const VibrationResidual& residual, double lowest_Hz, double highest_Hz,
                                 std::size_t count);

}  // namespace strainwave::analysis::diagnosis
