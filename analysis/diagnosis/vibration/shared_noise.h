// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "analysis/diagnosis/vibration/samples.h"

/// Accelerometers on one machine share noise: what moves the whole of it, a supply, an input stage. They are
/// then no independent witnesses: a chance line in what they share stands in all of them.
namespace strainwave::analysis::diagnosis {

/// A root of the inverse of the channels' correlation matrix C: Dᵀ D = C⁻¹, so that D times the channels of a
/// residual is as many series of equal noise that have nothing in common (its likelihood is that of a
/// Gaussian with this covariance).
///
/// @param channels  of one record, without their lines, of equal length; at least one.
Eigen::MatrixXd DecorrelationOf(std::span<const std::vector<double>> channels);

/// That of each record, in the place of its channels. Samples without weight count as zero.
void Decorrelate(const VibrationSamples& samples, std::span<const double> weights,
                 std::span<double> residual);

}  // namespace strainwave::analysis::diagnosis
