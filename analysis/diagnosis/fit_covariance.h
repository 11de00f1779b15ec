// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <span>

namespace strainwave::analysis::diagnosis {

/// Covariance of least-squares parameters from the derivatives of the prediction (samples × parameters, in
/// time order) under the autoregressive noise Σ that the residual shows (white where it shows none): (JᵀJ)⁻¹
/// JᵀΣJ (JᵀJ)⁻¹, with the degrees of freedom taken off. Exact for lines of any order, where a long-run
/// variance would stand for the slowest ones only. Samples without weight are left out; a parameter that
/// nothing determines has a variance of zero.
Eigen::MatrixXd FitCovariance(const Eigen::MatrixXd& sensitivities, std::span<const double> measured,
                              const Eigen::VectorXd& predicted, std::span<const double> weights,
                              std::span<const std::size_t> stretches, int largest_noise_order);

}  // namespace strainwave::analysis::diagnosis
