// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace strainwave::analysis::health {

/// Where a list of scores begins to rise steeply (docs/sources.md#lee-2023, eq. 12 to 14: the threshold of
/// risk priority numbers).
struct ScoreThreshold {
  std::vector<double> unique;      // scores, rounded, rising
  std::vector<int> frequency;      // of each
  std::vector<double> difference;  // to the score before, over the frequency; 0 for the first
  std::vector<std::size_t> peaks;  // places in `unique` whose difference is a local maximum
  double threshold{};              // the score at the peak that rises most over the three before it
  double rise_percent{};           // of that peak; 0: there were too few peaks, all scores count
};

/// Scores are rounded first, since 224 real numbers are all different and each frequency would be 1; the
/// source does not say that it does, and its example needs it. A peak needs a smaller (or equal, before it)
/// difference on both sides, and three peaks before it for its rise; one at the end counts.
/// @param rounding  0.01; 0: none.
ScoreThreshold ThresholdOf(const Eigen::VectorXd& score, double rounding = 0.01);

struct SelectionSettings {
  double rounding{0.01};
  double most_correlation{0.9};  // Pearson's, in magnitude: of two that are above, the lower score goes
  int least{1};                  // features a component, below the threshold where need be
  int most{12};
};

struct Selection {
  ScoreThreshold threshold;
  std::vector<Eigen::Index> above;  // the threshold, best first
  std::vector<Eigen::Index> kept;   // of them, best first
};

/// Features at or above the threshold, from the top; each that says what a better one has said goes.
/// @param features  n × features.
Selection SelectFeatures(const Eigen::MatrixXd& features, const Eigen::VectorXd& score,
                         const SelectionSettings& settings = {});

}  // namespace strainwave::analysis::health
