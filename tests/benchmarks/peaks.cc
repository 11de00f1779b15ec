// SPDX-License-Identifier: Apache-2.0
#include "tests/benchmarks/peaks.h"

// This file again for each kind of machine (docs/decisions/0018-vectors.md).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/benchmarks/peaks.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strainwave::peaks::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <typename Scalar>
HWY_INLINE double Run(std::size_t rounds, Scalar& result) {
  const hn::ScalableTag<Scalar> tag;
  using Vector = hn::Vec<decltype(tag)>;
  constexpr std::size_t kSums = 12;  // in flight at once: two a cycle of at most six cycles each
  const Vector factor = hn::Set(tag, static_cast<Scalar>(0.999));
  const Vector summand = hn::Set(tag, static_cast<Scalar>(0.001));
  Vector sums[kSums];
  for (Vector& sum : sums) sum = hn::Set(tag, result);
  for (std::size_t i = 0; i < rounds; ++i) {
    for (Vector& sum : sums) sum = hn::MulAdd(sum, factor, summand);
  }
  Vector total = sums[0];
  for (std::size_t s = 1; s < kSums; ++s) total = hn::Add(total, sums[s]);
  result = hn::GetLane(total);
  return 2.0 * static_cast<double>(rounds * kSums * hn::Lanes(tag));
}

HWY_ATTR double RunFloats(std::size_t rounds, float& result) { return Run(rounds, result); }
HWY_ATTR double RunDoubles(std::size_t rounds, double& result) { return Run(rounds, result); }

}  // namespace strainwave::peaks::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strainwave::peaks {

HWY_EXPORT(RunFloats);
HWY_EXPORT(RunDoubles);

double MultiplyAdd(std::size_t rounds, float& result) {
  return HWY_DYNAMIC_DISPATCH(RunFloats)(rounds, result);
}

double MultiplyAdd(std::size_t rounds, double& result) {
  return HWY_DYNAMIC_DISPATCH(RunDoubles)(rounds, result);
}

}  // namespace strainwave::peaks
#endif
