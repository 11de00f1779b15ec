// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "analysis/diagnosis/separable_study.h"

namespace strainwave::analysis::diagnosis {

/// The terms of one fit side by side, and the numbers that are fitted: for each term its coefficients, then
/// its shapes, term after term.
struct TermSet {
  std::vector<const SeparableTerm*> terms;
  std::size_t samples{};

  std::size_t coefficients() const;
  std::size_t shapes() const;
};

/// One solution of a term set.
struct SeparableSolution {
  std::vector<std::vector<double>> shapes;        // a list a term
  std::vector<std::vector<double>> coefficients;  // a list a term
  Eigen::MatrixXd design;                         // samples × coefficients
  Eigen::VectorXd predicted;
  double weighted_square_sum{};  // of what is left
};

/// Coefficients at given shapes: weighted least squares by the scaled normal equations; a direction that the
/// samples do not determine gets nothing.
SeparableSolution SolveCoefficients(const TermSet& set, std::span<const double> measured,
                                    std::span<const double> weights, std::vector<std::vector<double>> shapes);

/// Improves the shapes by damped Gauss–Newton steps on what the coefficients leave; never ends worse than it
/// began. `rounds` at most.
SeparableSolution RefineShapes(const TermSet& set, std::span<const double> measured,
                               std::span<const double> weights, SeparableSolution solution, int rounds);

/// Derivatives of the prediction by all numbers, in the order of TermSet: samples × (coefficients + shapes).
Eigen::MatrixXd Sensitivities(const TermSet& set, const SeparableSolution& solution);

}  // namespace strainwave::analysis::diagnosis
