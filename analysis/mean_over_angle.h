// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "analysis/harmonic_regression.h"

namespace strainwave::analysis {

/// What was measured over an angle: the fitted harmonics everywhere, and what they leave linearly between the
/// samples.
struct MeasuredCurve {
  std::span<const double>
      angle_rad;           // at least 2 samples of one revolution at most, in the order of the sweep
  const HarmonicFit& fit;  // with a residual for each sample
};

/// Mean over the angle that the sweep covers (`WeightedAngle`). Harmonics count with their integral, what
/// they leave by the trapezoid rule: between rows that are missing, or some of whose steps are longer than
/// half a period, a trapezoid says nothing of a harmonic. Its standard error holds the residuals' noise, with
/// its autocorrelation, and the errors of the amplitudes.
/// @throws std::invalid_argument as `AngleWeights`.
Estimate MeanOverAngle(const MeasuredCurve& curve);

/// Mean over the angle of first − second, each read at the angles of the other, so that grids may be offset.
/// Angles count modulo a turn: a sweep that was zeroed at its own start still meets the same teeth at the
/// same remainder. None if the two have no angle in common; across more than three usual steps there is none.
std::optional<double> MeanDifferenceAtEqualAngle(const MeasuredCurve& first, const MeasuredCurve& second);

}  // namespace strainwave::analysis
