// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "analysis/diagnosis/separable_study.h"

namespace strainwave::analysis::diagnosis {

/// The terms of one fit side by side, and the numbers that are fitted: for each term its coefficients, then
/// its nonlinear parameters, term after term.
struct TermSet {
  std::vector<const SeparableTerm*> terms;
  std::size_t samples{};
  FitPurpose purpose{FitPurpose::kCompare};
  bool it_pays{};  // to move the nonlinear parameters that are moved only then

  std::size_t coefficients() const;
  std::size_t nonlinear_parameters() const;
  bool Moves(const NonlinearParameterRange& range) const {
    return range.moved == Moved::kAlways ||
           (range.moved == Moved::kForErrors && purpose != FitPurpose::kCompare) ||
           (range.moved == Moved::kWhereItPays && (it_pays || purpose == FitPurpose::kReport));
  }
  std::size_t moved_nonlinear_parameters() const;
};

/// One solution of a term set.
struct SeparableSolution {
  std::vector<std::vector<double>> nonlinear_parameters;  // a list a term
  std::vector<std::vector<double>> coefficients;          // a list a term
  Eigen::MatrixXd moving;  // columns of the terms that have nonlinear parameters
  Eigen::VectorXd predicted;
  double weighted_square_sum{};  // of what is left
};

/// Weighted least squares of a term set. What the terms without nonlinear parameters bring to the normal
/// equations is worked out once, for all the nonlinear parameters that the others are tried with.
class SeparableProblem {
 public:
  /// Keeps a reference to the set.
  SeparableProblem(const TermSet& set, std::span<const double> measured, std::span<const double> weights);

  /// Coefficients at given nonlinear parameters (one list a term), by the scaled normal equations; a
  /// direction that the samples do not determine gets nothing.
  SeparableSolution Solve(std::vector<std::vector<double>> nonlinear_parameters) const;

  /// Improves the nonlinear parameters by damped Gauss–Newton steps on what the coefficients leave; never
  /// ends worse than it began. `rounds` at most.
  SeparableSolution Refine(SeparableSolution solution, int rounds) const;

 private:
  struct Normal {
    Eigen::MatrixXd gram;
    Eigen::VectorXd right;
  };
  Normal NormalOf(const Eigen::MatrixXd& further, const Eigen::VectorXd& target) const;
  Eigen::MatrixXd Moving(const std::vector<std::vector<double>>& nonlinear_parameters) const;

  const TermSet& set_;
  Eigen::VectorXd measured_;
  Eigen::VectorXd roots_;     // of the weights
  Eigen::MatrixXd fixed_;     // columns of the terms without nonlinear parameters
  Eigen::MatrixXd weighted_;  // the same times the roots
  Eigen::MatrixXd gram_;      // of these
  Eigen::Index moving_columns_{};
};

/// Derivatives of the prediction by all numbers, in the order of TermSet: samples × (coefficients + nonlinear
/// parameters).
Eigen::MatrixXd Sensitivities(const TermSet& set, const SeparableSolution& solution);

}  // namespace strainwave::analysis::diagnosis
