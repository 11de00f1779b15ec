// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <span>
#include <string>

#include "analysis/diagnosis/study.h"

namespace strainwave::analysis::diagnosis {

/// A formula for structure that no cause of the list explains. It describes; it is no knowledge of physics.
struct SparseFormula {
  std::string formula;     // "residual / arcmin = 0.213 cos(7 output_angle - 35 deg)"; empty: nothing stable
  double heldout_share{};  // of the residual's variance, on blocks that neither choice nor fit have seen
  std::string sentence;    // for the report; says what it is not
};

/// Sparse regression of a residual on functions of the study's regressors: sine and cosine of angles at small
/// orders and at lines found, powers, magnitude, sign, their products with the direction, decays over time.
/// Sequentially thresholded least squares; a term stays if at least 80 % of half-samples of blocks choose it.
/// The same seed gives the same formula.
///
/// Source: Brunton, Proctor & Kutz, PNAS 113 (2016) 3932; Meinshausen & Bühlmann, J. R. Statist. Soc. B 72
/// (2010) 417. Departures: thresholds are in standard errors, and sine and cosine of an order go together.
SparseFormula ProposeFormula(const Study& study, const Eigen::VectorXd& residual,
                             std::span<const double> weights, unsigned long long seed);

}  // namespace strainwave::analysis::diagnosis
