// SPDX-License-Identifier: Apache-2.0
#include "analysis/networks/adam_step.h"

#include <cmath>

// This file again for each kind of machine (docs/decisions/0018-vectors.md).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "analysis/networks/adam_step.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strainwave::analysis::networks::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <typename Scalar>
HWY_INLINE void Step(const AdamFactors<Scalar>& factors, std::size_t count,
                     const Scalar* HWY_RESTRICT gradient, Scalar* HWY_RESTRICT first,
                     Scalar* HWY_RESTRICT second, Scalar* HWY_RESTRICT parameters) {
  const hn::ScalableTag<Scalar> tag;
  const std::size_t lanes = hn::Lanes(tag);
  const auto beta1 = hn::Set(tag, factors.beta1);
  const auto beta2 = hn::Set(tag, factors.beta2);
  const auto rest1 = hn::Set(tag, Scalar(1) - factors.beta1);
  const auto rest2 = hn::Set(tag, Scalar(1) - factors.beta2);
  const auto step = hn::Set(tag, factors.step);
  const auto root = hn::Set(tag, Scalar(1) / factors.root);
  const auto epsilon = hn::Set(tag, factors.epsilon);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto slope = hn::LoadU(tag, gradient + i);
    const auto mean = hn::MulAdd(beta1, hn::LoadU(tag, first + i), hn::Mul(rest1, slope));
    const auto square = hn::MulAdd(beta2, hn::LoadU(tag, second + i), hn::Mul(rest2, hn::Mul(slope, slope)));
    const auto below = hn::MulAdd(hn::Sqrt(square), root, epsilon);
    hn::StoreU(mean, tag, first + i);
    hn::StoreU(square, tag, second + i);
    hn::StoreU(hn::Sub(hn::LoadU(tag, parameters + i), hn::Div(hn::Mul(step, mean), below)), tag,
               parameters + i);
  }
  for (; i < count; ++i) {
    const Scalar slope = gradient[i];
    first[i] = factors.beta1 * first[i] + (Scalar(1) - factors.beta1) * slope;
    second[i] = factors.beta2 * second[i] + (Scalar(1) - factors.beta2) * slope * slope;
    parameters[i] -= factors.step * first[i] / (std::sqrt(second[i]) / factors.root + factors.epsilon);
  }
}

HWY_ATTR void StepFloats(const AdamFactors<float>& factors, std::size_t count, const float* gradient,
                         float* first, float* second, float* parameters) {
  Step(factors, count, gradient, first, second, parameters);
}

HWY_ATTR void StepDoubles(const AdamFactors<double>& factors, std::size_t count, const double* gradient,
                          double* first, double* second, double* parameters) {
  Step(factors, count, gradient, first, second, parameters);
}

}  // namespace strainwave::analysis::networks::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strainwave::analysis::networks {

HWY_EXPORT(StepFloats);
HWY_EXPORT(StepDoubles);

void AdamStep(const AdamFactors<float>& factors, std::size_t count, const float* gradient, float* first,
              float* second, float* parameters) {
  HWY_DYNAMIC_DISPATCH(StepFloats)(factors, count, gradient, first, second, parameters);
}

void AdamStep(const AdamFactors<double>& factors, std::size_t count, const double* gradient, double* first,
              double* second, double* parameters) {
  HWY_DYNAMIC_DISPATCH(StepDoubles)(factors, count, gradient, first, second, parameters);
}

}  // namespace strainwave::analysis::networks
#endif
