// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

/// The two sums of products that networks and long records spend their time in, for the widest vectors that
/// the machine has (chosen when the program starts). The order of additions depends on the machine and the
/// sizes, never on the values or on threads. `Scalar` is float or double.
namespace strainwave::analysis {

enum class Sum { kOverwrite, kAdd };

/// Numbers of a matrix in rows that lie `stride` apart, each row without gaps.
template <typename Scalar>
struct RowView {
  Scalar* data;
  std::ptrdiff_t stride;
};

/// Numbers of a matrix with any distance from row to row and from column to column.
template <typename Scalar>
struct GridView {
  Scalar* data;
  std::ptrdiff_t row_stride;
  std::ptrdiff_t column_stride;
};

/// c(r, j) = ∑ over s of a(r, s) b(s, j): each row of c is a combination of rows of b.
/// r < rows, s < terms, j < width.
template <typename Scalar>
void CombineRows(GridView<const Scalar> a, RowView<const Scalar> b, RowView<Scalar> c, std::ptrdiff_t rows,
                 std::ptrdiff_t terms, std::ptrdiff_t width, Sum sum);

/// c(r, s) = ∑ over i of a(r, i) b(s, i): each number of c is the product of a row of a and a row of b.
/// r < rows, s < columns, i < terms.
template <typename Scalar>
void MultiplyRows(RowView<const Scalar> a, RowView<const Scalar> b, GridView<Scalar> c, std::ptrdiff_t rows,
                  std::ptrdiff_t columns, std::ptrdiff_t terms, Sum sum);

}  // namespace strainwave::analysis
