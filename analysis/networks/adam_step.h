// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace strainwave::analysis::networks {

/// What one step of Adam needs for every parameter.
template <typename Scalar>
struct AdamFactors {
  Scalar beta1;
  Scalar beta2;
  Scalar step;  // rate over what corrects the mean
  Scalar root;  // of what corrects the mean of squares
  Scalar epsilon;
};

/// One step for `count` parameters p of slopes g, with the means m and v of g and g²:
///   m ← β₁ m + (1 − β₁) g,  v ← β₂ v + (1 − β₂) g²,  p ← p − step m / (√v / root + ε).
/// In vectors as wide as the machine's; the last places may differ from machine to machine.
void AdamStep(const AdamFactors<float>& factors, std::size_t count, const float* gradient, float* first,
              float* second, float* parameters);
void AdamStep(const AdamFactors<double>& factors, std::size_t count, const double* gradient, double* first,
              double* second, double* parameters);

}  // namespace strainwave::analysis::networks
