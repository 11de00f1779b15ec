// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <span>
#include <string>

#include "analysis/diagnosis/study.h"
#include "analysis/parallel_for.h"

/// Is a residual nothing but noise? All p-values are small where it is not. Samples of weight zero are gaps;
/// others count as residual · √weight. Segments (first samples, ascending from 0) are not joined.
namespace strainwave::analysis::diagnosis {

/// Whiteness against the neighbours: lags 1 to min(20, n / 5). 1 for fewer than 10 samples. Each lag counts
/// with the pairs that are there, so that gaps cost power and nothing else.
///
/// @param noise_order  parameters of an autoregressive model that was fitted to this very residual; each
///   costs a degree of freedom. Those of a regression cost none and do not belong here.
///
/// Source: Ljung & Box, Biometrika 65 (1978) 297.
double LjungBoxP(std::span<const double> residual, std::span<const double> weights,
                 std::span<const std::size_t> segments, int noise_order);

/// Number of runs of equal sign, two-sided, given how many samples are positive and negative; exact zeros are
/// gaps. Sees slow structure even where the noise has heavy tails. 1 for fewer than 10 samples or one sign.
///
/// Source: Wald & Wolfowitz, Ann. Math. Statist. 11 (1940) 147; the variance with gaps follows by counting
/// pairs of neighbours.
double RunsP(std::span<const double> residual, std::span<const double> weights,
             std::span<const std::size_t> segments);

/// Where a residual follows a regressor most closely.
struct CrossCorrelation {
  double p_value{1.0};   // of the largest one, corrected for the lags searched
  double coefficient{};  // after whitening
  std::ptrdiff_t lag{};  // > 0: the residual comes later
};

/// Largest cross-correlation over lags −largest_lag … largest_lag. Both are filtered by the autoregressive
/// model of the residual first, so that its own autocorrelation does not count as agreement; what the
/// regressor's autocorrelation makes of neighbouring lags is taken out of the nuisance term (Glaz & Johnson,
/// JASA 79 (1984) 436: product form).
CrossCorrelation LargestCrossCorrelation(std::span<const double> residual, std::span<const double> regressor,
                                         std::span<const double> weights,
                                         std::span<const std::size_t> segments, int largest_lag = 20);

/// The same, the p-value alone.
double CrossCorrelationP(std::span<const double> residual, std::span<const double> regressor,
                         std::span<const double> weights, std::span<const std::size_t> segments,
                         int largest_lag = 20);

/// What stands out most in a residual, in words with numbers, at most three things, each after the ones
/// before were taken out: a line over an angle or over time, a window, or a smooth dependence on a regressor.
///
/// Each is judged by its likelihood ratio under autoregressive noise, times the search locations. Empty where
/// nothing has p < 10⁻³. A line over an angle of even steps is named with the orders that fold onto it.
/// @param parallel  over what is looked at
std::string DescribeResidual(const Study& study, const Eigen::VectorXd& residual,
                             std::span<const double> weights, const ParallelFor& parallel = InTurn);

}  // namespace strainwave::analysis::diagnosis
