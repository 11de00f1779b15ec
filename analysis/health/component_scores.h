// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace strainwave::analysis::health {

/// How well each feature tells one component, whatever the others are like (docs/sources.md#lee-2023, eq. 5
/// to 11), within each cell of the levels of the other components:
///   correlation: Spearman's, of the feature with the component's health, by mid-ranks;
///   Fisher's ratio: V_B / V_W with V_B = Σ over levels of (m_k − m)², which does not count records, and
///   V_W = Σ over records of (x − m_k)², which does. It ranks features of one data set, no more.
struct ComponentScores {
  Eigen::VectorXd correlation;  // |Σ over cells| as eq. 9 prints it, over the cells
  Eigen::VectorXd magnitudes;   // Σ over cells of |·|, over the cells
  Eigen::VectorXd fisher;       // mean over the cells
  Eigen::VectorXd score;  // α · correlation + (1 − α) · fisher, each from 0 to 1 over all features
  int cells{};            // that have two levels of the component or more
};

struct ScoreSettings {
  double alpha{0.8};
  /// In place of `correlation`: trends that run against each other in two cells then do not cancel.
  bool sum_of_magnitudes{};
};

/// @param features  n × features; what is constant or not finite has a score of 0.
/// @param health  n × components.
/// @param levels  of it, as `LevelsOf` gives them.
/// @throws std::invalid_argument if sizes differ or there is no such component.
ComponentScores ScoreFeatures(const Eigen::MatrixXd& features, const Eigen::MatrixXd& health,
                              const Eigen::MatrixXi& levels, Eigen::Index component,
                              const ScoreSettings& settings = {});

}  // namespace strainwave::analysis::health
