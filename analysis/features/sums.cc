// SPDX-License-Identifier: Apache-2.0
#include "analysis/features/sums.h"

// This file again for each kind of machine (docs/decisions/0018-vectors.md).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "analysis/features/sums.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strainwave::analysis::features::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, 8>;
using Vector = hn::Vec<Tag>;
constexpr Tag kTag;
constexpr std::size_t kLanes = hn::MaxLanes(kTag);
// Eight running sums on every machine, whatever its registers hold, so that each gives the same bits.
constexpr std::size_t kStep = 8;
constexpr std::size_t kParts = kStep / kLanes;

struct Eight {
  Vector parts[kParts];
};

HWY_INLINE Eight All(double value) {
  Eight out;
  for (Vector& part : out.parts) part = hn::Set(kTag, value);
  return out;
}

HWY_INLINE Eight At(const double* place) {
  Eight out;
  for (std::size_t p = 0; p < kParts; ++p) out.parts[p] = hn::LoadU(kTag, place + p * kLanes);
  return out;
}

HWY_INLINE Eight operator+(const Eight& a, const Eight& b) {
  Eight out;
  for (std::size_t p = 0; p < kParts; ++p) out.parts[p] = hn::Add(a.parts[p], b.parts[p]);
  return out;
}

HWY_INLINE Eight operator-(const Eight& a, const Eight& b) {
  Eight out;
  for (std::size_t p = 0; p < kParts; ++p) out.parts[p] = hn::Sub(a.parts[p], b.parts[p]);
  return out;
}

HWY_INLINE Eight operator*(const Eight& a, const Eight& b) {
  Eight out;
  for (std::size_t p = 0; p < kParts; ++p) out.parts[p] = hn::Mul(a.parts[p], b.parts[p]);
  return out;
}

HWY_INLINE void Put(const Eight& values, double* place) {
  for (std::size_t p = 0; p < kParts; ++p) hn::StoreU(values.parts[p], kTag, place + p * kLanes);
}

HWY_INLINE double Total(const Eight& sums) {
  double s[kStep];
  Put(sums, s);
  return ((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + (s[6] + s[7]));
}

HWY_INLINE double SumOfBlock(const double* x, std::size_t n) {
  Eight sums = At(x);
  std::size_t i = kStep;
  for (; i + kStep <= n; i += kStep) sums = sums + At(x + i);
  double sum = Total(sums);
  for (; i < n; ++i) sum += x[i];
  return sum;
}

HWY_ATTR double SumByHalves(const double* x, std::size_t n) {
  constexpr std::size_t kBlock = 128;
  if (n < kStep) {
    double sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) sum += x[i];
    return sum;
  }
  if (n <= kBlock) return SumOfBlock(x, n);
  const std::size_t half = n / 2 / kStep * kStep;
  return SumByHalves(x, half) + SumByHalves(x + half, n - half);
}

// ∑ over t of x(t) x(t+l) x(t+2l), and of x(t+2l)² x(t+l) − x(t+l) x(t)².
HWY_ATTR void AddProducts(const double* x, std::size_t lag, std::size_t count, double& third_sum,
                          double& asymmetry_sum) {
  Eight third = All(0.0);
  Eight asymmetry = All(0.0);
  std::size_t t = 0;
  for (; t + kStep <= count; t += kStep) {
    const Eight x0 = At(x + t);
    const Eight x1 = At(x + t + lag);
    const Eight x2 = At(x + t + 2 * lag);
    third = third + x2 * x1 * x0;
    asymmetry = asymmetry + (x2 * x2 * x1 - x1 * x0 * x0);
  }
  third_sum = Total(third);
  asymmetry_sum = Total(asymmetry);
  for (; t < count; ++t) {
    const double x0 = x[t];
    const double x1 = x[t + lag];
    const double x2 = x[t + 2 * lag];
    third_sum += x2 * x1 * x0;
    asymmetry_sum += x2 * x2 * x1 - x1 * x0 * x0;
  }
}

HWY_ATTR void AddSquares(const double* x, std::size_t n, double& squares, double& squared_steps) {
  Eight of_values = All(0.0);
  Eight of_steps = All(0.0);
  std::size_t t = 0;
  for (; t + kStep < n; t += kStep) {
    const Eight here = At(x + t);
    const Eight step = At(x + t + 1) - here;
    of_values = of_values + here * here;
    of_steps = of_steps + step * step;
  }
  squares = Total(of_values);
  squared_steps = Total(of_steps);
  for (; t < n; ++t) {
    squares += x[t] * x[t];
    if (t + 1 < n) squared_steps += (x[t + 1] - x[t]) * (x[t + 1] - x[t]);
  }
}

HWY_ATTR std::size_t CountCrossings(const double* x, std::size_t n, double level) {
  std::size_t count = 0;
  std::size_t t = 0;
  const Vector levels = hn::Set(kTag, level);
  for (; t + kLanes < n; t += kLanes) {
    const auto here = hn::Gt(hn::LoadU(kTag, x + t), levels);
    const auto next = hn::Gt(hn::LoadU(kTag, x + t + 1), levels);
    count += hn::CountTrue(kTag, hn::Xor(here, next));
  }
  for (; t + 1 < n; ++t) count += (x[t] > level) != (x[t + 1] > level) ? 1 : 0;
  return count;
}

HWY_ATTR double ShiftAll(const double* x, std::size_t n, double shift, double* y) {
  Eight squares = All(0.0);
  const Eight shifts = All(shift);
  std::size_t t = 0;
  for (; t + kStep <= n; t += kStep) {
    const Eight shifted = At(x + t) - shifts;
    Put(shifted, y + t);
    squares = squares + shifted * shifted;
  }
  double sum = Total(squares);
  for (; t < n; ++t) {
    y[t] = x[t] - shift;
    sum += y[t] * y[t];
  }
  return sum;
}

// As many lags at a time as have their sums in registers.
template <std::size_t Lags>
HWY_INLINE void AddLags(const double* x, std::size_t n, std::size_t begin, std::size_t lag, double* out) {
  Eight sums[Lags];
  for (Eight& sum : sums) sum = All(0.0);
  std::size_t t = begin;
  for (; t + kStep <= n; t += kStep) {
    const Eight here = At(x + t);
    for (std::size_t l = 0; l < Lags; ++l) sums[l] = sums[l] + here * At(x + t - lag - l);
  }
  for (std::size_t l = 0; l < Lags; ++l) {
    out[lag + l] = Total(sums[l]);
    for (std::size_t rest = t; rest < n; ++rest) out[lag + l] += x[rest] * x[rest - lag - l];
  }
}

HWY_ATTR void AddLagProducts(const double* x, std::size_t n, double* out, std::size_t most_lag) {
  constexpr std::size_t kTogether = 11 / kParts;
  std::size_t lag = 0;
  if constexpr (kTogether > 1) {
    for (; lag + kTogether <= most_lag + 1; lag += kTogether) AddLags<kTogether>(x, n, most_lag, lag, out);
  }
  for (; lag <= most_lag; ++lag) AddLags<1>(x, n, most_lag, lag, out);
}

}  // namespace strainwave::analysis::features::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strainwave::analysis::features {

HWY_EXPORT(SumByHalves);
HWY_EXPORT(AddProducts);
HWY_EXPORT(AddSquares);
HWY_EXPORT(CountCrossings);
HWY_EXPORT(ShiftAll);
HWY_EXPORT(AddLagProducts);

double PairwiseSum(std::span<const double> x) {
  return HWY_DYNAMIC_DISPATCH(SumByHalves)(x.data(), x.size());
}

std::size_t CrossingCount(std::span<const double> x, double level) {
  return HWY_DYNAMIC_DISPATCH(CountCrossings)(x.data(), x.size(), level);
}

double Shift(std::span<const double> x, double shift, std::span<double> y) {
  return HWY_DYNAMIC_DISPATCH(ShiftAll)(x.data(), x.size(), shift, y.data());
}

NeighbourProducts NeighbourProductsOf(std::span<const double> x) {
  NeighbourProducts products;
  HWY_DYNAMIC_DISPATCH(AddSquares)(x.data(), x.size(), products.squares, products.squared_steps);
  for (std::size_t lag = 1; lag <= kMostProductLag && 2 * lag < x.size(); ++lag) {
    const std::size_t count = x.size() - 2 * lag;
    double third = 0.0;
    double asymmetry = 0.0;
    HWY_DYNAMIC_DISPATCH(AddProducts)(x.data(), lag, count, third, asymmetry);
    products.third[lag - 1] = third / static_cast<double>(count);
    products.asymmetry[lag - 1] = asymmetry / static_cast<double>(count);
  }
  return products;
}

void LagProducts(std::span<const double> x, std::span<double> out) {
  HWY_DYNAMIC_DISPATCH(AddLagProducts)(x.data(), x.size(), out.data(), out.size() - 1);
}

}  // namespace strainwave::analysis::features
#endif
