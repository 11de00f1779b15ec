// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <memory>
#include <vector>

namespace strainwave::analysis::prediction {

/// Averaged regression trees: what a network has to beat that needs no scaling and no care.
class Forest {
 public:
  /// One forest an output.
  /// @param features, targets  n × inputs and n × outputs.
  /// @param trees  each on rows drawn with replacement, √inputs of the inputs at every branch.
  /// @throws std::invalid_argument if the row counts differ, there are fewer than 10 rows, or no tree.
  ///
  /// Source: Breiman (2001), as OpenCV's ml module has it; the draws are those of its fixed seed.
  Forest(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets, int trees);
  Forest(Forest&&) noexcept;
  Forest& operator=(Forest&&) noexcept;
  ~Forest();

  Eigen::MatrixXd Predict(const Eigen::MatrixXd& features) const;

 private:
  struct Trees;
  std::vector<std::unique_ptr<Trees>> of_output_;
};

}  // namespace strainwave::analysis::prediction
