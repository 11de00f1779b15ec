// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <type_traits>

namespace strainwave::analysis::networks {

/// to[column][row] = from[row][column], both without gaps and apart from one another. Floats go in blocks of
/// four by four through registers.
template <typename Scalar>
void Transpose(const Scalar* from, std::ptrdiff_t rows, std::ptrdiff_t columns, Scalar* to) {
  std::ptrdiff_t row = 0;
#if defined(__GNUC__) && !defined(__clang__)
  if constexpr (std::is_same_v<Scalar, float>) {
    using Four = float __attribute__((vector_size(16), aligned(4), may_alias));
    for (; row + 4 <= rows; row += 4) {
      const float* in = from + row * columns;
      std::ptrdiff_t column = 0;
      for (; column + 4 <= columns; column += 4) {
        const Four a = *reinterpret_cast<const Four*>(in + column);
        const Four b = *reinterpret_cast<const Four*>(in + columns + column);
        const Four c = *reinterpret_cast<const Four*>(in + 2 * columns + column);
        const Four d = *reinterpret_cast<const Four*>(in + 3 * columns + column);
        const Four ab_low = __builtin_shufflevector(a, b, 0, 4, 1, 5);
        const Four ab_high = __builtin_shufflevector(a, b, 2, 6, 3, 7);
        const Four cd_low = __builtin_shufflevector(c, d, 0, 4, 1, 5);
        const Four cd_high = __builtin_shufflevector(c, d, 2, 6, 3, 7);
        float* out = to + column * rows + row;
        *reinterpret_cast<Four*>(out) = __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5);
        *reinterpret_cast<Four*>(out + rows) = __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7);
        *reinterpret_cast<Four*>(out + 2 * rows) = __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5);
        *reinterpret_cast<Four*>(out + 3 * rows) = __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7);
      }
      for (; column < columns; ++column) {
        for (std::ptrdiff_t i = 0; i < 4; ++i) to[column * rows + row + i] = in[i * columns + column];
      }
    }
  }
#endif
  for (; row < rows; ++row) {
    for (std::ptrdiff_t column = 0; column < columns; ++column) {
      to[column * rows + row] = from[row * columns + column];
    }
  }
}

}  // namespace strainwave::analysis::networks
