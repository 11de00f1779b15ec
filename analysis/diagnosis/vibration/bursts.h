// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "analysis/diagnosis/vibration/starts.h"

namespace strainwave::analysis::diagnosis {

/// A time and frequency at which a residual is large for a while.
struct BurstSpot {
  double power{};  // drop of the sum of squares, in variances of the noise
  double frequency_Hz{};
  double centre_s{};
  double width_s{};
};

/// The strongest spots of the first record, strongest first; at least two widths or a fifth of the frequency
/// apart.
std::vector<BurstSpot> FindBursts(const VibrationResidual& residual, std::size_t count);

/// A tone that comes and goes once.
std::optional<TermFit> SearchBurst(const VibrationResidual& residual, std::size_t index);

}  // namespace strainwave::analysis::diagnosis
