// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <span>
#include <vector>

#include "analysis/diagnosis/sparse_library.h"

namespace strainwave::analysis::diagnosis {

/// Sums over one block: enough to fit any choice of terms on any choice of blocks.
struct BlockSums {
  Eigen::MatrixXd gram;
  Eigen::VectorXd right;
};

/// A residual and a library, summed up by blocks; columns and residual are centred, columns standardised.
struct SparseProblem {
  std::vector<LibraryTerm> terms;
  std::vector<Eigen::Index> first_column;  // of each term
  std::vector<BlockSums> blocks;
  Eigen::VectorXd mean;   // of the columns
  Eigen::VectorXd scale;  // 1 / standard deviation

  /// Columns of these terms.
  std::vector<Eigen::Index> Columns(std::span<const std::size_t> of_terms) const;
};

/// @param block_of  block of each sample, not falling.
SparseProblem SumUp(std::vector<LibraryTerm> terms, const Eigen::VectorXd& residual,
                    std::span<const double> weights, std::span<const std::size_t> block_of,
                    std::size_t blocks);

/// Terms that at least 80 % of half-samples of these blocks choose, of `pairs` complementary pairs of halves
/// (Shah & Samworth, J. R. Statist. Soc. B 75 (2013) 55).
std::vector<std::size_t> StableTerms(const SparseProblem& problem, std::span<const std::size_t> blocks,
                                     int pairs, unsigned long long seed);

/// Coefficients of the terms in the units of the library's columns, behind them the constant.
Eigen::VectorXd SparseCoefficients(const SparseProblem& problem, std::span<const std::size_t> terms,
                                   std::span<const std::size_t> blocks, double residual_mean);

}  // namespace strainwave::analysis::diagnosis
