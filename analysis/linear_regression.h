// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>

namespace strainwave::analysis {

/// How the standard errors of a least-squares fit are made.
enum class ErrorModel {
  kIndependent,     // one variance, no autocorrelation: σ² (XᵀX)⁻¹
  kAutocorrelated,  // sandwich with the long-run covariance of the scores, see analysis/autocorrelation.h
};

/// A linear least-squares fit y ≈ X b.
struct LinearFit {
  Eigen::VectorXd coefficients;
  Eigen::MatrixXd covariance;            // of the coefficients
  Eigen::VectorXd residuals;             // y − X b
  double residual_standard_deviation{};  // with n − rank in the denominator; 0 when nothing is left
  Eigen::Index rank{};

  double StandardError(Eigen::Index column) const;
};

/// Fits y ≈ X b by column-pivoting QR. Columns that the others make up get a coefficient of zero and a zero
/// variance; `rank` says how many are left.
///
/// @param design  n × p, rows in time order where `errors` is kAutocorrelated.
/// @throws std::invalid_argument if the row counts differ or n < p.
LinearFit FitLinear(const Eigen::MatrixXd& design, const Eigen::VectorXd& y, ErrorModel errors);

/// Covariance of least-squares parameters with Jacobian J and residuals r: (JᵀJ)⁻¹ S (JᵀJ)⁻¹ with S the
/// long-run covariance of the scores Jᵢ rᵢ, times n / (n − p). Parameters whose column is zero get zero
/// variance.
Eigen::MatrixXd SandwichCovariance(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residuals);

}  // namespace strainwave::analysis
