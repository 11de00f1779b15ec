// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace strainwave::analysis::statistics {

/// How far a point lies from the convex hull of others: 0 inside. By the nearest mixture of them with
/// weights from 0 up that sum to 1.
///
/// @param points  n × d, n ≥ 1.
/// @param point  d values.
/// @throws std::invalid_argument if there is no point or the sizes differ.
///
/// Source: docs/sources.md#lawson-1974 (non-negative least squares).
double DistanceFromHull(const Eigen::MatrixXd& points, const Eigen::VectorXd& point);

}  // namespace strainwave::analysis::statistics
