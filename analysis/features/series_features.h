// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "analysis/features/sorted_series.h"

namespace strainwave::analysis::features {

inline constexpr std::size_t kSeriesFeatures = 35;

/// What the features are called, in their order: tsfresh's name of the calculator and its parameters.
extern const std::array<std::string_view, kSeriesFeatures> kSeriesFeatureNames;

/// Memory that the features of a series take; owned by the caller, used again by the next series.
struct SeriesWorkspace {
  SortedSeries sorted;
  std::vector<double> centred;
};

/// The features of one series x₀ … x₍n−1₎, population moments throughout:
///   mean, median, standard deviation σ, variance, quantiles 5, 25, 75, 95 % (linear), root mean square,
///   mean_change (x₍n−1₎ − x₀)/(n − 1), changes of x > 0 and of x > mean, entropy in nats of 10 even bins
///   from least to greatest, autoregressive coefficients (`autoregression.h`), ∑ x², autocorrelation at lag
///   1, c3(l) = mean x(t) x(t+l) x(t+2l), cid_ce √∑(x(t+1) − x(t))² / σ, place of the first maximum / n,
///   Langevin fixed point (`langevin.h`), time_reversal(l) = mean x(t+2l)² x(t+l) − x(t+l) x(t)²; l = 1,
///   2, 3.
/// Where tsfresh has no value there is none: NaN for mean_change of one value, for the autocorrelation where
/// the variance is 1e-8 or less, for the fixed point where bins coincide, for the autoregressive coefficients
/// 0 to 9 of fewer than 21 values, whose last one is 0 there; 0 for c3 and time_reversal where n ≤ 2l, for
/// cid_ce where σ = 0.
///
/// @param x  at least one value, finite.
/// @throws std::invalid_argument if the series is empty or a value is not finite.
///
/// Source: tsfresh 0.21.2, the definitions of its feature calculators.
void SeriesFeatures(std::span<const double> x, SeriesWorkspace& workspace,
                    std::span<double, kSeriesFeatures> out);

}  // namespace strainwave::analysis::features
