// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <span>

namespace strainwave::analysis {

/// Length of the autocorrelation of a residual in samples: the bandwidth of a Bartlett kernel by the
/// first-order autoregressive plug-in rule, 1.1447 (4ρ² / (1 − ρ²)² · n)^⅓, at least n^⅓ and at most n
/// / 8. ρ is the larger of the lag-1 autocorrelation and, where that one is significant, the ratio of lag 2
/// to lag 1, which stays high when white noise hides a slow component.
///
/// Source: Andrews, Econometrica 59 (1991) 817, eq. 6.2 and 6.4.
Eigen::Index KernelBandwidth(std::span<const double> residual);

/// Lag-1 autocorrelation, within ±0.9; 0 for fewer than 8 values.
double LagOneCorrelation(std::span<const double> residual);

/// x[i] − rho x[i − 1]; the first value is kept as √(1 − rho²) x[0].
Eigen::MatrixXd Whiten(const Eigen::MatrixXd& rows, double rho);

/// Long-run covariance of the sum of the rows of `scores` (one row a sample, in time order), with Bartlett
/// weights 1 − |lag| / bandwidth: the mean over all windows of `bandwidth` rows of the outer product
/// of the window's sum. Positive semidefinite by construction. `bandwidth` 1 takes the rows as
/// independent.
///
/// Source: Newey & West, Econometrica 55 (1987) 703; the form as a mean over windows follows by counting.
Eigen::MatrixXd LongRunCovariance(const Eigen::MatrixXd& scores, Eigen::Index bandwidth);

/// The same for the scores of a least-squares fit (rows Jᵢ rᵢ of a Jacobian that changes slowly), whitened
/// first by the lag-1 correlation of the residuals and coloured again by 1 / (1 − ρ)²: a window alone misses
/// the far end of the autocorrelation.
///
/// Source: Andrews & Monahan, Econometrica 60 (1992) 953.
Eigen::MatrixXd ScoreCovariance(const Eigen::MatrixXd& scores, std::span<const double> residuals);

/// Factor by which the variance of a mean of these residuals exceeds that of independent ones; at least 1.
double VarianceInflation(std::span<const double> residual);

}  // namespace strainwave::analysis
