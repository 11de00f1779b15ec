// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/stability_selection.h"

#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>
#include <numeric>
#include <random>

#include "analysis/decompositions.h"
#include "analysis/shuffle.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

constexpr double kKeptShare = 0.8;  // of the half-samples
constexpr double kTermP = 0.0027;   // three standard errors, in each half-sample

struct Normal {
  Eigen::MatrixXd gram;
  Eigen::VectorXd right;
};

// Of these columns, summed over the blocks.
Normal NormalEquations(const SparseProblem& problem, const std::vector<Index>& columns,
                       std::span<const std::size_t> blocks) {
  const Index p = static_cast<Index>(columns.size());
  Normal normal{Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Zero(p)};
  for (const std::size_t b : blocks) {
    normal.gram += problem.blocks[b].gram(columns, columns);
    normal.right += problem.blocks[b].right(columns);
  }
  return normal;
}

// p-value of each term, by the scatter of the blocks' scores: right whatever the autocorrelation within a
// block.
std::vector<double> TermPValues(const SparseProblem& problem, std::span<const std::size_t> terms,
                                std::span<const std::size_t> blocks) {
  const std::vector<Index> columns = problem.Columns(terms);
  const Index p = static_cast<Index>(columns.size());
  auto [gram, right] = NormalEquations(problem, columns, blocks);
  gram.diagonal().array() += 1e-9 * gram.diagonal().maxCoeff();
  const SymmetricFactor factor(gram);
  const Eigen::VectorXd coefficients = factor.Solve(right);
  Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(p, p);
  for (const std::size_t b : blocks) {
    const Eigen::VectorXd score =
        problem.blocks[b].right(columns) - problem.blocks[b].gram(columns, columns) * coefficients;
    meat.noalias() += score * score.transpose();
  }
  const double clusters = static_cast<double>(blocks.size());
  const Eigen::MatrixXd covariance =
      factor.Solve(Eigen::MatrixXd(factor.Solve(meat).transpose())) * (clusters / (clusters - 1.0));
  std::vector<double> p_values;
  Index first = 0;
  for (const std::size_t t : terms) {
    const Index k = problem.terms[t].columns.cols();
    const Eigen::VectorXd part = coefficients.segment(first, k);
    const Eigen::MatrixXd block = covariance.block(first, first, k, k);
    const double wald = part.dot(ShortestLeastSquares(block, part).col(0)) / static_cast<double>(k);
    const boost::math::fisher_f distribution(static_cast<double>(k), clusters - static_cast<double>(k));
    p_values.push_back(std::isfinite(wald)
                           ? boost::math::cdf(boost::math::complement(distribution, std::max(0.0, wald)))
                           : 1.0);
    first += k;
  }
  return p_values;
}

// Sequential thresholding: the weaker half of what is below the threshold goes, until all that is left is
// above. It starts from the terms that say most each by itself: with more terms than a quarter of the blocks
// their scores would not tell the errors (Fan & Lv, J. R. Statist. Soc. B 70 (2008) 849).
std::vector<std::size_t> Threshold(const SparseProblem& problem, std::span<const std::size_t> blocks) {
  std::vector<std::pair<double, std::size_t>> alone;
  for (std::size_t t = 0; t < problem.terms.size(); ++t) {
    alone.emplace_back(TermPValues(problem, {&t, 1}, blocks).front(), t);
  }
  std::sort(alone.begin(), alone.end());
  alone.resize(std::min(alone.size(), std::max<std::size_t>(3, blocks.size() / 4)));
  std::vector<std::size_t> terms;
  for (const auto& [p_value, t] : alone) terms.push_back(t);
  std::sort(terms.begin(), terms.end());
  while (!terms.empty()) {
    const std::vector<double> p_values = TermPValues(problem, terms, blocks);
    std::vector<std::size_t> weak;
    for (std::size_t i = 0; i < terms.size(); ++i) {
      if (p_values[i] > kTermP) weak.push_back(i);
    }
    if (weak.empty()) break;
    std::sort(weak.begin(), weak.end(),
              [&](std::size_t a, std::size_t b) { return p_values[a] > p_values[b]; });
    weak.resize((weak.size() + 1) / 2);
    std::sort(weak.rbegin(), weak.rend());
    for (const std::size_t i : weak) {
      terms.erase(terms.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
  return terms;
}

}  // namespace

std::vector<Index> SparseProblem::Columns(std::span<const std::size_t> of_terms) const {
  std::vector<Index> columns;
  for (const std::size_t t : of_terms) {
    for (Index j = 0; j < terms[t].columns.cols(); ++j) columns.push_back(first_column[t] + j);
  }
  return columns;
}

SparseProblem SumUp(std::vector<LibraryTerm> terms, const Eigen::VectorXd& residual,
                    std::span<const double> weights, std::span<const std::size_t> block_of,
                    std::size_t blocks) {
  SparseProblem problem;
  problem.terms = std::move(terms);
  Index count = 0;
  for (const LibraryTerm& term : problem.terms) {
    problem.first_column.push_back(count);
    count += term.columns.cols();
  }
  const Eigen::Map<const Eigen::VectorXd> w(weights.data(), residual.size());
  Eigen::MatrixXd design(residual.size(), count);
  for (std::size_t t = 0; t < problem.terms.size(); ++t) {
    design.middleCols(problem.first_column[t], problem.terms[t].columns.cols()) = problem.terms[t].columns;
  }
  problem.mean = design.transpose() * w / w.sum();
  design.rowwise() -= problem.mean.transpose();
  problem.scale = (w.asDiagonal() * design.cwiseAbs2()).colwise().sum().transpose() / w.sum();
  problem.scale = problem.scale.cwiseSqrt().cwiseInverse();
  design = w.cwiseSqrt().asDiagonal() * design * problem.scale.asDiagonal();
  const Eigen::VectorXd centred =
      w.cwiseSqrt().asDiagonal() * (residual.array() - w.dot(residual) / w.sum()).matrix();

  problem.blocks.resize(blocks);
  std::size_t from = 0;
  while (from < block_of.size()) {
    std::size_t to = from;
    while (to < block_of.size() && block_of[to] == block_of[from]) ++to;
    const auto rows = static_cast<Index>(to - from);
    const auto part = design.middleRows(static_cast<Index>(from), rows);
    problem.blocks[block_of[from]] = {part.transpose() * part,
                                      part.transpose() * centred.segment(static_cast<Index>(from), rows)};
    from = to;
  }
  return problem;
}

std::vector<std::size_t> StableTerms(const SparseProblem& problem, std::span<const std::size_t> blocks,
                                     int pairs, unsigned long long seed) {
  std::mt19937_64 engine(seed);
  std::vector<int> kept(problem.terms.size(), 0);
  std::vector<std::size_t> order(blocks.begin(), blocks.end());
  const std::size_t half = order.size() / 2;
  for (int pair = 0; pair < pairs; ++pair) {
    Shuffle(order, engine);
    for (const std::size_t from : {std::size_t{0}, half}) {
      for (const std::size_t t : Threshold(problem, std::span(order).subspan(from, half))) {
        ++kept[t];
      }
    }
  }
  std::vector<std::size_t> stable;
  for (std::size_t t = 0; t < kept.size(); ++t) {
    if (kept[t] >= static_cast<int>(std::ceil(kKeptShare * 2.0 * pairs))) stable.push_back(t);
  }
  return stable;
}

Eigen::VectorXd SparseCoefficients(const SparseProblem& problem, std::span<const std::size_t> terms,
                                   std::span<const std::size_t> blocks, double residual_mean) {
  const std::vector<Index> columns = problem.Columns(terms);
  const Index p = static_cast<Index>(columns.size());
  auto [gram, right] = NormalEquations(problem, columns, blocks);
  Eigen::VectorXd numbers(p + 1);
  numbers.head(p) = problem.scale(columns).cwiseProduct(ShortestLeastSquares(gram, right).col(0));
  numbers(p) = residual_mean - numbers.head(p).dot(problem.mean(columns));
  return numbers;
}

}  // namespace strainwave::analysis::diagnosis
