// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace strainwave::analysis::health {

inline constexpr int kMostLevels = 8;

/// The level of each row of each component, from 0 up in the order of its health: each value is one where
/// there are `most` values or fewer; else shares of the rows of as equal a size as ties allow, a half of
/// `most` of them.
/// @param health  n × components.
Eigen::MatrixXi LevelsOf(const Eigen::MatrixXd& health, int most = kMostLevels);

/// How many of the components the rows can tell apart: the rank of the health less its mean.
int DistinguishableComponents(const Eigen::MatrixXd& health);

}  // namespace strainwave::analysis::health
