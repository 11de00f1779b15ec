// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <algorithm>

#include "analysis/products.h"

/// Products of columns, summed over blocks of rows that the second cache holds.
namespace strainwave::analysis::diagnosis {

/// Some rows of columns that lie `stride` apart.
struct ColumnBlock {
  const double* data;
  Eigen::Index stride;
  Eigen::Index columns;
};

inline ColumnBlock BlockOf(const Eigen::Ref<const Eigen::MatrixXd>& matrix, Eigen::Index first_row) {
  return {matrix.data() + first_row, matrix.outerStride(), matrix.cols()};
}

/// sum += aᵀ b, over so many rows.
inline void AddProducts(const ColumnBlock& a, const ColumnBlock& b, Eigen::Index rows,
                        Eigen::Ref<Eigen::MatrixXd> sum) {
  MultiplyRows<double>({a.data, a.stride}, {b.data, b.stride}, {sum.data(), 1, sum.outerStride()}, a.columns,
                       b.columns, rows, Sum::kAdd);
}

/// The same of products that are symmetric: the lower half, and a little more.
inline void AddSymmetric(const ColumnBlock& a, const ColumnBlock& b, Eigen::Index rows,
                         Eigen::MatrixXd& sum) {
  constexpr Eigen::Index kTogether = 6;  // columns; right of the diagonal is computed for them alone
  for (Eigen::Index first = 0; first < a.columns; first += kTogether) {
    const Eigen::Index width = std::min(kTogether, a.columns - first);
    MultiplyRows<double>({a.data + first * a.stride, a.stride}, {b.data, b.stride},
                         {sum.data() + first, 1, sum.outerStride()}, width, first + width, rows, Sum::kAdd);
  }
}

inline Eigen::MatrixXd WithUpperHalf(const Eigen::MatrixXd& lower) {
  return lower.selfadjointView<Eigen::Lower>();
}

}  // namespace strainwave::analysis::diagnosis
