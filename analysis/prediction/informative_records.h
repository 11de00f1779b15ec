// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <vector>

namespace strainwave::analysis::prediction {

/// Which records to measure (stiffness and transmission error take minutes, vibration a second) when there
/// is time for `count` of them: first the one nearest to the middle, then always the one that is farthest
/// from all chosen, so that no state of the gear is far from a measured one.
///
/// @param features  n × inputs, scaled.
/// @throws std::invalid_argument if count is not between 1 and n.
///
/// Source: Gonzalez (1985), Clustering to minimize the maximum intercluster distance; Sener & Savarese
/// (2018) for its use in choosing what to label.
std::vector<Eigen::Index> ChooseInformative(const Eigen::MatrixXd& features, Eigen::Index count);

}  // namespace strainwave::analysis::prediction
