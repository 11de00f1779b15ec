// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/separable_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

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
  const Eigen::LDLT<Eigen::MatrixXd> factor(gram);
  if (factor.info() == Eigen::Success && factor.rcond() > kUndetermined) {
    return scale.cwiseProduct(factor.solve(right));
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gram);
  const double largest = std::max(eigen.eigenvalues().maxCoeff(), 1e-300);
  const Eigen::VectorXd inverse = eigen.eigenvalues().unaryExpr(
      [&](double value) { return value > kUndetermined * largest ? 1.0 / value : 0.0; });
  return scale.cwiseProduct(eigen.eigenvectors() * inverse.asDiagonal() *
                            (eigen.eigenvectors().transpose() * right));
}

Eigen::MatrixXd WeightedGram(const Eigen::MatrixXd& design, std::span<const double> weights) {
  const Eigen::MatrixXd rows = AsVector(weights).cwiseSqrt().asDiagonal() * design;
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(design.cols(), design.cols());
  gram.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
  return gram.selfadjointView<Eigen::Lower>();
}

void FillTerm(const SeparableTerm& term, std::span<const double> shapes,
              Eigen::Ref<Eigen::MatrixXd> columns) {
  term.fill(shapes, columns);
}

// Columns of the derivative by each shape: a central difference of the term's prediction.
Eigen::MatrixXd ShapeColumns(const TermSet& set, const SeparableSolution& at) {
  Eigen::MatrixXd columns(ToIndex(set.samples), ToIndex(set.shapes()));
  Index next = 0;
  for (std::size_t t = 0; t < set.terms.size(); ++t) {
    const SeparableTerm& term = *set.terms[t];
    if (term.shapes.empty()) continue;
    const Eigen::VectorXd coefficients = AsVector(at.coefficients[t]);
    Eigen::MatrixXd up(ToIndex(set.samples), ToIndex(term.columns));
    Eigen::MatrixXd down(up.rows(), up.cols());
    for (std::size_t s = 0; s < term.shapes.size(); ++s) {
      const ShapeRange& range = term.shapes[s];
      std::vector<double> shapes = at.shapes[t];
      const double centre = shapes[s];
      const double high = std::min(range.high, centre + 0.05 * range.step);
      const double low = std::max(range.low, centre - 0.05 * range.step);
      shapes[s] = high;
      FillTerm(term, shapes, up);
      shapes[s] = low;
      FillTerm(term, shapes, down);
      columns.col(next++) = (up - down) * coefficients / std::max(high - low, 1e-300);
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

std::size_t TermSet::shapes() const {
  std::size_t sum = 0;
  for (const SeparableTerm* term : terms) sum += term->shapes.size();
  return sum;
}

SeparableSolution SolveCoefficients(const TermSet& set, std::span<const double> measured,
                                    std::span<const double> weights,
                                    std::vector<std::vector<double>> shapes) {
  SeparableSolution solution;
  solution.shapes = std::move(shapes);
  solution.design.resize(ToIndex(set.samples), ToIndex(set.coefficients()));
  Index first = 0;
  for (std::size_t t = 0; t < set.terms.size(); ++t) {
    const Index columns = ToIndex(set.terms[t]->columns);
    FillTerm(*set.terms[t], solution.shapes[t], solution.design.middleCols(first, columns));
    first += columns;
  }
  const Eigen::VectorXd weighted = AsVector(weights).cwiseProduct(AsVector(measured));
  const Eigen::VectorXd numbers =
      SolveNormal(WeightedGram(solution.design, weights), solution.design.transpose() * weighted, 0.0, 0);
  first = 0;
  for (const SeparableTerm* term : set.terms) {
    const auto columns = ToIndex(term->columns);
    solution.coefficients.emplace_back(numbers.data() + first, numbers.data() + first + columns);
    first += columns;
  }
  solution.predicted = solution.design * numbers;
  solution.weighted_square_sum = (AsVector(measured) - solution.predicted).cwiseAbs2().dot(AsVector(weights));
  return solution;
}

SeparableSolution RefineShapes(const TermSet& set, std::span<const double> measured,
                               std::span<const double> weights, SeparableSolution solution, int rounds) {
  const Index shapes = ToIndex(set.shapes());
  if (shapes == 0) return solution;
  double damping = 1e-3;
  for (int round = 0; round < rounds; ++round) {
    Eigen::MatrixXd joint(solution.design.rows(), solution.design.cols() + shapes);
    joint << solution.design, ShapeColumns(set, solution);
    const Eigen::VectorXd residual = AsVector(measured) - solution.predicted;
    const Eigen::MatrixXd gram = WeightedGram(joint, weights);
    const Eigen::VectorXd right = joint.transpose() * AsVector(weights).cwiseProduct(residual);
    bool better = false;
    double drop = 0.0;
    for (int attempt = 0; attempt < 5 && !better; ++attempt) {
      const Eigen::VectorXd step = SolveNormal(gram, right, damping, shapes);
      std::vector<std::vector<double>> moved = solution.shapes;
      Index next = solution.design.cols();
      for (std::size_t t = 0; t < set.terms.size(); ++t) {
        for (std::size_t s = 0; s < moved[t].size(); ++s) {
          const ShapeRange& range = set.terms[t]->shapes[s];
          const double change = std::clamp(step(next++), -5.0 * range.step, 5.0 * range.step);
          moved[t][s] = std::clamp(moved[t][s] + change, range.low, range.high);
        }
      }
      SeparableSolution candidate = SolveCoefficients(set, measured, weights, std::move(moved));
      drop = solution.weighted_square_sum - candidate.weighted_square_sum;
      better = drop > 0.0;
      damping = better ? std::max(1e-9, 0.2 * damping) : 8.0 * damping;
      if (better) solution = std::move(candidate);
    }
    // A drop that moves the log-likelihood of ten thousand samples by less than a hundredth.
    if (!better || drop < 2e-6 * solution.weighted_square_sum) break;
  }
  return solution;
}

Eigen::MatrixXd Sensitivities(const TermSet& set, const SeparableSolution& solution) {
  const Eigen::MatrixXd by_shape = ShapeColumns(set, solution);
  Eigen::MatrixXd all(solution.design.rows(), solution.design.cols() + by_shape.cols());
  Index from_design = 0;
  Index from_shapes = 0;
  Index to = 0;
  for (const SeparableTerm* term : set.terms) {
    const Index columns = ToIndex(term->columns);
    const Index curved = ToIndex(term->shapes.size());
    all.middleCols(to, columns) = solution.design.middleCols(from_design, columns);
    all.middleCols(to + columns, curved) = by_shape.middleCols(from_shapes, curved);
    to += columns + curved;
    from_design += columns;
    from_shapes += curved;
  }
  return all;
}

}  // namespace strainwave::analysis::diagnosis
