// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "analysis/diagnosis/study.h"

namespace strainwave::analysis::diagnosis {

/// Root of a variance that rounding may have left below zero.
inline double StandardErrorOf(double variance) { return std::sqrt(std::max(0.0, variance)); }

/// What the samples know of the parameters of a fit.
struct FitErrors {
  Eigen::MatrixXd covariance;  // along the directions that they determine; zero along the others
  /// A column for each direction in which the parameters may go without changing the prediction at any
  /// sample; none where everything is determined.
  Eigen::MatrixXd open;
};

/// Errors of least-squares parameters from the derivatives of the prediction (samples × parameters, in time
/// order) under the autoregressive noise Σ that the residual shows (white where it shows none): (JᵀJ)⁻¹
/// JᵀΣJ (JᵀJ)⁻¹, with the degrees of freedom taken off. Exact for lines of any order, where a long-run
/// variance would stand for the slowest ones only. Samples without weight are left out.
///
/// @param ridge  what each squared parameter adds to the sum of squares, one a parameter: what is known of it
///   beside the samples, so that it is not open.
FitErrors ErrorsOfFit(const Eigen::MatrixXd& sensitivities, std::span<const double> measured,
                      const Eigen::VectorXd& predicted, std::span<const double> weights,
                      std::span<const std::size_t> segments, int largest_noise_order,
                      const Eigen::VectorXd& ridge);

/// A number as one of several models has it, with that model's likelihood over the best one's.
struct Believed {
  double likelihood{};
  double value{};
  double standard_error{};
};

/// Standard error of the first model's number where the data cannot tell which model is true: 1.96 of it to
/// either side hold 95 % of what all of them believe. Infinite where the first one's is, or where too much
/// belief is in models whose error is.
double StandardErrorOver(std::span<const Believed> models);

/// What another model says of numbers, with its likelihood over that of the best one.
struct OtherModel {
  double likelihood{};
  std::vector<ParameterValue> numbers;
};

/// Makes the standard errors of the best model's numbers those over other models, too, each by its name.
void WidenErrors(std::span<const OtherModel> others, std::vector<ParameterValue>& numbers);

}  // namespace strainwave::analysis::diagnosis
