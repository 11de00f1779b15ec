// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/diagnosis/diagnosis_report.h"

/// What pictures and text look at in a residual. Residuals in SI, one a sample.
namespace strainwave::bench {

/// A regressor as it is drawn: in the unit of its axis, an angle of more than one turn folded into one.
std::vector<double> AbscissaeOf(const analysis::diagnosis::Regressor& regressor);
bool IsFolded(const analysis::diagnosis::Regressor& regressor);

/// Means of a residual in bins of a regressor, with what repeats of the noise would let them vary.
struct BinnedMeans {
  std::vector<double> abscissa;
  std::vector<double> mean;
  std::vector<double> two_standard_errors;
};
/// Bins of equal width, or one for each value where there are few; those of fewer than four samples are left
/// out.
BinnedMeans BinMeans(std::span<const double> abscissa, std::span<const double> residual,
                     std::span<const double> weights);

/// Share of the nominal residual's variance that its mean in bins of a regressor explains, less what the
/// number of bins explains by chance.
struct RegressorShare {
  std::size_t index{};  // into Study::regressors()
  std::string title;    // without the unit
  double share{};
};
/// Largest first.
std::vector<RegressorShare> SharesByRegressor(const DiagnosisReport& report);

/// Amplitudes of a residual at orders per turn of an angle, by least squares one order at a time, so that
/// uneven samples do as well as even ones.
std::vector<double> AmplitudesAt(std::span<const double> angle_rad, std::span<const double> residual,
                                 std::span<const double> weights, double lowest_order, double step,
                                 std::size_t count);

/// Indices of at most about `most` of `count` samples, evenly spread.
std::vector<std::size_t> Thinned(std::size_t count, std::size_t most);

}  // namespace strainwave::bench
