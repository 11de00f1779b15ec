// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "analysis/diagnosis/study.h"

namespace strainwave::analysis::diagnosis {

/// A function of the regressors that a formula may contain, in the units of the pictures' axes.
struct LibraryTerm {
  Eigen::MatrixXd columns;  // samples × 1, or × 2 for cosine and sine of one order
  /// "0.213 cos(7 output_angle - 35 deg)"; the sign goes in front.
  std::function<std::string(std::span<const double> coefficients)> describe;
};

/// Cosine and sine of angles at orders 1 to 4 and, if asked for, at lines found in the residual; powers,
/// magnitude, sign, their products with the direction, decays over time. Terms that nearly repeat an earlier
/// one (correlation above 0.95) are left out, so that two of them cannot share a selection.
std::vector<LibraryTerm> BuildLibrary(const Study& study, std::span<const double> residual,
                                      std::span<const double> weights, bool with_lines);

}  // namespace strainwave::analysis::diagnosis
