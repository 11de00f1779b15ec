// SPDX-License-Identifier: Apache-2.0
#include "analysis/networks/vector_functions.h"

#include <cmath>

#include "analysis/vector_clones.h"

// The library's header says this itself only under -ffast-math, which would also forget what NaN is.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__)
extern "C" {
__attribute__((simd("notinbranch"))) float expf(float) noexcept;
__attribute__((simd("notinbranch"))) double exp(double) noexcept;
__attribute__((simd("notinbranch"))) float tanhf(float) noexcept;
__attribute__((simd("notinbranch"))) double tanh(double) noexcept;
}
#endif

namespace strainwave::analysis::networks {
namespace {

using Index = std::ptrdiff_t;

STRAINWAVE_VECTOR_CLONES void SigmoidHere(float* z, Index count) {
  for (Index i = 0; i < count; ++i) z[i] = 1.0F / (1.0F + ::expf(-z[i]));
}
STRAINWAVE_VECTOR_CLONES void SigmoidHere(double* z, Index count) {
  for (Index i = 0; i < count; ++i) z[i] = 1.0 / (1.0 + ::exp(-z[i]));
}
STRAINWAVE_VECTOR_CLONES void TanhHere(float* z, Index count) {
  for (Index i = 0; i < count; ++i) z[i] = ::tanhf(z[i]);
}
STRAINWAVE_VECTOR_CLONES void TanhHere(double* z, Index count) {
  for (Index i = 0; i < count; ++i) z[i] = ::tanh(z[i]);
}

}  // namespace

template <typename Scalar>
void Sigmoid(Scalar* z, Index count) {
  SigmoidHere(z, count);
}
template <typename Scalar>
void Tanh(Scalar* z, Index count) {
  TanhHere(z, count);
}

template void Sigmoid(float*, Index);
template void Sigmoid(double*, Index);
template void Tanh(float*, Index);
template void Tanh(double*, Index);

}  // namespace strainwave::analysis::networks
