// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <string>
#include <vector>

#include "analysis/diagnosis/study.h"

namespace strainwave::analysis::diagnosis {

/// Numbers of a model, as they were fitted, in the words of people.
using DescribeNumbers = std::function<std::vector<ParameterValue>(const Eigen::VectorXd& numbers)>;

/// Finds which of a fit's numbers the samples leave open, term by term, and says so once all are seen.
class OpenNumbers {
 public:
  /// @param directions  FitErrors::open, of all parameters of the fit.
  explicit OpenNumbers(Eigen::MatrixXd directions) : directions_(std::move(directions)) {}

  /// Gives an infinite standard error to each of `described` that changes where the term's own numbers, from
  /// `first` on among the fit's, go along an open direction.
  void Mark(const Eigen::VectorXd& numbers, Eigen::Index first, const DescribeNumbers& describe,
            std::vector<ParameterValue>& described);

  /// One sentence on all that was marked, with the sum of two that is known where neither is; none where
  /// nothing was.
  std::vector<std::string> Words() const;

 private:
  struct Open {
    ParameterValue number;  // with the error that it has where the rest is held
    double change{};        // along the last of the directions that changes it
  };
  Eigen::MatrixXd directions_;
  std::vector<Open> open_;
};

}  // namespace strainwave::analysis::diagnosis
