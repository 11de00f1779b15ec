// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/separable_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/decompositions.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

Index ToIndex(std::size_t n) { return static_cast<Index>(n); }

Eigen::Map<const Eigen::VectorXd> AsVector(std::span<const double> values) {
  return {values.data(), ToIndex(values.size())};
}

// Minimum-norm solution of the normal equations, columns scaled to one; `ridge` damps the last columns.
Eigen::VectorXd SolveNormal(Eigen::MatrixXd gram, Eigen::VectorXd right, double ridge, Index damped) {
  constexpr double kUndetermined = 1e-11;
  const Index p = gram.rows();
  Eigen::VectorXd scale(p);
  for (Index j = 0; j < p; ++j) scale(j) = gram(j, j) > 0.0 ? 1.0 / std::sqrt(gram(j, j)) : 0.0;
  gram = scale.asDiagonal() * gram * scale.asDiagonal();
  right = scale.cwiseProduct(right);
  for (Index j = p - damped; j < p; ++j) gram(j, j) += ridge;
  const SymmetricFactor factor(gram);
  const Eigen::VectorXd pivots = factor.pivots();
  if (factor.succeeded() && pivots.minCoeff() > kUndetermined * pivots.maxCoeff()) {
    return scale.cwiseProduct(factor.Solve(right));
  }
  const SymmetricParts eigen = SymmetricEigen(gram);
  const double largest = std::max(eigen.values.maxCoeff(), 1e-300);
  const Eigen::VectorXd inverse = eigen.InverseAbove(kUndetermined * largest);
  return scale.cwiseProduct(eigen.vectors * inverse.asDiagonal() * (eigen.vectors.transpose() * right));
}

// Products of columns with each other.
Eigen::MatrixXd SquaresOf(const Eigen::MatrixXd& columns) {
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
  if (columns.cols() == 0) return lower;  // Eigen binds a reference to its first element
  lower.selfadjointView<Eigen::Lower>().rankUpdate(columns.transpose());
  return lower.selfadjointView<Eigen::Lower>();
}

// Columns of the derivative by each shape, of the term's prediction: a central difference where standard
// errors are asked for; where a step is, one to the side that has more room, of half the evaluations.
Eigen::MatrixXd NonlinearParameterColumns(const TermSet& set, const SeparableSolution& at) {
  const bool central = set.purpose != FitPurpose::kCompare;
  Eigen::MatrixXd columns(ToIndex(set.samples), ToIndex(set.nonlinear_parameters()));
  Index next = 0;
  Index moving = 0;  // first column of the term
  for (std::size_t t = 0; t < set.terms.size(); ++t) {
    const SeparableTerm& term = *set.terms[t];
    if (term.nonlinear_parameters.empty()) continue;
    const Eigen::VectorXd coefficients = AsVector(at.coefficients[t]);
    const auto here = at.moving.middleCols(moving, ToIndex(term.columns));
    moving += here.cols();
    Eigen::MatrixXd change(ToIndex(set.samples), here.cols());
    Eigen::MatrixXd back(central ? change.rows() : 0, here.cols());
    for (std::size_t s = 0; s < term.nonlinear_parameters.size(); ++s) {
      const NonlinearParameterRange& range = term.nonlinear_parameters[s];
      if (!set.Moves(range)) {
        columns.col(next++).setZero();
        continue;
      }
      std::vector<double> nonlinear_parameters = at.nonlinear_parameters[t];
      const double centre = nonlinear_parameters[s];
      const double high = std::min(range.high, centre + 0.05 * range.step);
      const double low = std::max(range.low, centre - 0.05 * range.step);
      const double to = central || high - centre >= centre - low ? high : low;
      const double from = central ? low : centre;
      nonlinear_parameters[s] = to;
      term.fill(nonlinear_parameters, change);
      if (central) {
        nonlinear_parameters[s] = from;
        term.fill(nonlinear_parameters, back);
        change -= back;
      } else {
        change -= here;
      }
      columns.col(next++) = change * coefficients / (to == from ? 1e-300 : to - from);
    }
  }
  return columns;
}

}  // namespace

std::size_t TermSet::coefficients() const {
  std::size_t sum = 0;
  for (const SeparableTerm* term : terms) sum += term->columns;
  return sum;
}

std::size_t TermSet::nonlinear_parameters() const {
  std::size_t sum = 0;
  for (const SeparableTerm* term : terms) sum += term->nonlinear_parameters.size();
  return sum;
}

std::size_t TermSet::moved_nonlinear_parameters() const {
  std::size_t sum = 0;
  for (const SeparableTerm* term : terms) {
    sum += static_cast<std::size_t>(
        std::count_if(term->nonlinear_parameters.begin(), term->nonlinear_parameters.end(),
                      [this](const NonlinearParameterRange& range) { return Moves(range); }));
  }
  return sum;
}

SeparableProblem::SeparableProblem(const TermSet& set, std::span<const double> measured,
                                   std::span<const double> weights)
    : set_(set), measured_(AsVector(measured)), roots_(AsVector(weights).cwiseSqrt()) {
  Index fixed = 0;
  for (const SeparableTerm* term : set.terms) {
    (term->nonlinear_parameters.empty() ? fixed : moving_columns_) += ToIndex(term->columns);
  }
  fixed_.resize(ToIndex(set.samples), fixed);
  Index next = 0;
  for (const SeparableTerm* term : set.terms) {
    if (!term->nonlinear_parameters.empty()) continue;
    const Index columns = ToIndex(term->columns);
    term->fill({}, fixed_.middleCols(next, columns));
    next += columns;
  }
  weighted_ = roots_.asDiagonal() * fixed_;
  gram_ = SquaresOf(weighted_);
  next = 0;
  for (const SeparableTerm* term : set.terms) {
    if (!term->nonlinear_parameters.empty()) continue;
    gram_.diagonal().segment(next, ToIndex(term->columns)).array() += term->ridge;
    next += ToIndex(term->columns);
  }
}

// Normal equations of a target by the fixed columns and these further ones.
SeparableProblem::Normal SeparableProblem::NormalOf(const Eigen::MatrixXd& further,
                                                    const Eigen::VectorXd& target) const {
  const Index fixed = gram_.rows();
  const Index more = further.cols();
  const Eigen::MatrixXd rows = roots_.asDiagonal() * further;
  const Eigen::VectorXd weighted_target = roots_.cwiseProduct(target);
  Normal normal{Eigen::MatrixXd(fixed + more, fixed + more), Eigen::VectorXd(fixed + more)};
  normal.gram.topLeftCorner(fixed, fixed) = gram_;
  normal.gram.topRightCorner(fixed, more).noalias() = weighted_.transpose() * rows;
  normal.gram.bottomLeftCorner(more, fixed) = normal.gram.topRightCorner(fixed, more).transpose();
  normal.gram.bottomRightCorner(more, more) = SquaresOf(rows);
  normal.right.head(fixed).noalias() = weighted_.transpose() * weighted_target;
  normal.right.tail(more).noalias() = rows.transpose() * weighted_target;
  return normal;
}

Eigen::MatrixXd SeparableProblem::Moving(const std::vector<std::vector<double>>& nonlinear_parameters) const {
  Eigen::MatrixXd columns(fixed_.rows(), moving_columns_);
  Index next = 0;
  for (std::size_t t = 0; t < set_.terms.size(); ++t) {
    if (set_.terms[t]->nonlinear_parameters.empty()) continue;
    const Index count = ToIndex(set_.terms[t]->columns);
    set_.terms[t]->fill(nonlinear_parameters[t], columns.middleCols(next, count));
    next += count;
  }
  return columns;
}

SeparableSolution SeparableProblem::Solve(std::vector<std::vector<double>> nonlinear_parameters) const {
  SeparableSolution solution;
  solution.nonlinear_parameters = std::move(nonlinear_parameters);
  solution.moving = Moving(solution.nonlinear_parameters);
  const Normal normal = NormalOf(solution.moving, measured_);
  const Eigen::VectorXd numbers = SolveNormal(normal.gram, normal.right, 0.0, 0);
  Index fixed_next = 0;
  Index moving_next = fixed_.cols();
  for (const SeparableTerm* term : set_.terms) {
    Index& next = term->nonlinear_parameters.empty() ? fixed_next : moving_next;
    const auto columns = ToIndex(term->columns);
    solution.coefficients.emplace_back(numbers.data() + next, numbers.data() + next + columns);
    next += columns;
  }
  solution.predicted =
      fixed_ * numbers.head(fixed_.cols()) + solution.moving * numbers.tail(solution.moving.cols());
  solution.weighted_square_sum = roots_.cwiseProduct(measured_ - solution.predicted).squaredNorm();
  return solution;
}

SeparableSolution SeparableProblem::Refine(SeparableSolution solution, int rounds) const {
  const Index nonlinear_parameters = ToIndex(set_.nonlinear_parameters());
  // A drop that moves the log-likelihood of ten thousand samples by less than a hundredth.
  constexpr double kNothing = 2e-6;
  constexpr double kForeseen = 0.1;  // of it, by a step that is straight, below which none is tried
  double damping = 1e-3;
  for (int round = 0; round < rounds; ++round) {
    Eigen::MatrixXd further(fixed_.rows(), moving_columns_ + nonlinear_parameters);
    further << solution.moving, NonlinearParameterColumns(set_, solution);
    const Normal normal = NormalOf(further, measured_ - solution.predicted);
    bool better = false;
    double drop = 0.0;
    for (int attempt = 0; attempt < 5 && !better; ++attempt) {
      const Eigen::VectorXd step = SolveNormal(normal.gram, normal.right, damping, nonlinear_parameters);
      if (normal.right.dot(step) < kForeseen * kNothing * solution.weighted_square_sum) break;
      std::vector<std::vector<double>> moved = solution.nonlinear_parameters;
      Index next = step.size() - nonlinear_parameters;
      for (std::size_t t = 0; t < set_.terms.size(); ++t) {
        for (std::size_t s = 0; s < moved[t].size(); ++s) {
          const NonlinearParameterRange& range = set_.terms[t]->nonlinear_parameters[s];
          const double change = std::clamp(step(next++), -5.0 * range.step, 5.0 * range.step);
          moved[t][s] = std::clamp(moved[t][s] + change, range.low, range.high);
        }
      }
      SeparableSolution candidate = Solve(std::move(moved));
      drop = solution.weighted_square_sum - candidate.weighted_square_sum;
      better = drop > 0.0;
      damping = better ? std::max(1e-9, 0.2 * damping) : 8.0 * damping;
      if (better) solution = std::move(candidate);
    }
    if (!better || drop < kNothing * solution.weighted_square_sum) break;
  }
  return solution;
}

Eigen::MatrixXd Sensitivities(const TermSet& set, const SeparableSolution& solution) {
  const Eigen::MatrixXd by_nonlinear_parameter = NonlinearParameterColumns(set, solution);
  Eigen::MatrixXd all(ToIndex(set.samples), ToIndex(set.coefficients() + set.nonlinear_parameters()));
  Index from_nonlinear_parameters = 0;
  Index to = 0;
  for (std::size_t t = 0; t < set.terms.size(); ++t) {
    const Index columns = ToIndex(set.terms[t]->columns);
    const Index curved = ToIndex(set.terms[t]->nonlinear_parameters.size());
    set.terms[t]->fill(solution.nonlinear_parameters[t], all.middleCols(to, columns));
    all.middleCols(to + columns, curved) =
        by_nonlinear_parameter.middleCols(from_nonlinear_parameters, curved);
    to += columns + curved;
    from_nonlinear_parameters += curved;
  }
  return all;
}

}  // namespace strainwave::analysis::diagnosis
