// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

/// Functions of many numbers at once, for the widest vectors that the machine has: glibc's vector mathematics
/// (libmvec), within 4 units in the last place, which may differ from machine to machine. Where the compiler
/// or the library has none, the same number by number. NaN stays NaN; `Scalar` is float or double.
namespace strainwave::analysis::networks {

/// Each z becomes 1 / (1 + exp(−z)).
template <typename Scalar>
void Sigmoid(Scalar* z, std::ptrdiff_t count);

/// Each z becomes tanh z.
template <typename Scalar>
void Tanh(Scalar* z, std::ptrdiff_t count);

}  // namespace strainwave::analysis::networks
