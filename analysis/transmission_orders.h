// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/harmonic_regression.h"
#include "analysis/transmission_error.h"

namespace strainwave::analysis {

/// A source of transmission error and its order per output revolution.
struct OrderCandidate {
  double order{};
  std::string name;
};

/// The known ones of a gear whose fixed circular spline has 2 · |ratio| + 2 teeth (docs/effects.md E2).
std::vector<OrderCandidate> KnownOrders(double ratio);

/// Candidates and further lines of one revolution of error, fitted.
struct OrderAnalysis {
  std::vector<OrderLine> lines;  // strongest first
  HarmonicFit fit;
  std::vector<std::string> notes;
  /// Why the wave generator's second harmonic, the largest line of a sound gear, is not seen as large as it
  /// is; empty where it is.
  std::string second_harmonic_hidden;
};

/// @param output_angle_rad, error_rad  the samples of one full revolution, at least 8, in the order of the
///   sweep.
OrderAnalysis AnalyseOrders(std::span<const double> output_angle_rad, std::span<const double> error_rad,
                            double ratio);

}  // namespace strainwave::analysis
