// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <span>

namespace strainwave::analysis::diagnosis {

/// How many of the numbers whose range is known before need not be charged for. BIC would charge each by ln
/// samples; what it is charged instead is ln |1 + R I R / 2π|, where I is the information on them beside
/// everything else and R holds their ranges: nothing where the record says nothing of them (the evidence of
/// Laplace; Kass & Raftery, JASA 90 (1995) 773).
///
/// @param by_known   derivatives of the prediction by these numbers, times the root of each sample's weight
/// @param by_others  the same by all other numbers of the fit, one at least
/// @param ranges     one a known number, in its unit
/// @param variance   of the weighted residual
/// @param samples    with weight
double KnownBefore(const Eigen::MatrixXd& by_known, Eigen::MatrixXd by_others, std::span<const double> ranges,
                   double variance, double samples);

}  // namespace strainwave::analysis::diagnosis
