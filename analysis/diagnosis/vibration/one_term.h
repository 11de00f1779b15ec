// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cstddef>
#include <vector>

#include "analysis/diagnosis/vibration/samples.h"
#include "analysis/diagnosis/vibration/solver.h"
#include "analysis/diagnosis/vibration/terms.h"

namespace strainwave::analysis::diagnosis {

/// One term beside a fitted model: what searches compare.
struct TermFit {
  struct Channel {
    Eigen::VectorXd coefficients;  // of the term's columns; empty where it is not observable
    Eigen::MatrixXd inverse;       // of the term's normal matrix, the model's own columns projected out
    double drop{};                 // of the sum of squares
  };
  VibrationTerm term;
  std::vector<Channel> channels;
  double square_sum{};  // of model and term
  double weight_sum{};
  int free_parameters{};

  double bic() const;
  double variance() const { return square_sum / std::max(1.0, weight_sum - free_parameters); }
};

/// Fits single terms to what a model leaves, its terms' nonlinear parameters held. The model's columns are
/// projected out once; a term then costs its own columns' products with these and with the residual, whatever
/// the number of channels.
class OneTermSolver {
 public:
  OneTermSolver(const VibrationSamples& samples, const VibrationSolver& solver,
                const VibrationSolution& base);

  TermFit Fit(VibrationTerm term) const;

  /// Levenberg–Marquardt on the term's nonlinear parameters.
  TermFit Refine(TermFit fit, int rounds) const;

  /// Leaves the term out of channels where it does not pay for its coefficients; the channel in which it is
  /// largest keeps it.
  void Prune(TermFit& fit) const;

  /// What the model with the term leaves, times the roots of the weights, all samples.
  Eigen::VectorXd Residual(const TermFit& fit) const;

 private:
  /// Channels whose products with a term's columns are the same: of one run, with the same samples without
  /// weight and no filter of their own.
  struct Group {
    std::size_t run{};
    std::vector<std::size_t> channels;
    std::vector<std::size_t> firsts;  // their first samples in the response
    bool weighted{};
    Eigen::VectorXd root_weights;
    Eigen::MatrixXd basis;      // orthonormal, of the model's columns under the weights
    Eigen::MatrixXd residuals;  // under the weights, one column a channel
  };

  /// Products of a term's columns, followed by their slopes by each shape, the model's projected out.
  struct Products {
    Eigen::MatrixXd own;
    Eigen::MatrixXd with_residuals;
  };
  std::vector<Products> ProductsOf(const VibrationTerm& term, bool slopes) const;
  TermFit Solve(VibrationTerm term, const std::vector<Products>& products) const;
  SharedStep Step(const TermFit& fit, const std::vector<Products>& products) const;

  /// The same for a term that is a filter, not columns.
  TermFit SolveFilter(VibrationTerm term) const;
  SharedStep StepFilter(const TermFit& fit,
                        const std::vector<VibrationNonlinearParameter>& nonlinear_parameters) const;
  Eigen::VectorXd Innovations(const VibrationTerm& term) const;
  /// What narrow-band terms predict of the channels of each group.
  /// @param take  (group, direction of its channels × terms, predicted along it under its weights × terms)
  template <typename Take>
  void ForEachPredicted(std::span<const VibrationTerm> narrowband, const Take& take) const;

  const VibrationSamples& samples_;
  const VibrationSolver& solver_;
  const VibrationSolution& base_;
  Eigen::VectorXd left_;  // by the base, all samples
  std::vector<Group> groups_;
  std::vector<std::size_t> first_of_run_;  // channel
};

}  // namespace strainwave::analysis::diagnosis
