// SPDX-License-Identifier: Apache-2.0
#include "analysis/features/sums.h"

#include "analysis/vector_clones.h"

namespace strainwave::analysis::features {
namespace {

using Masks = long long __attribute__((vector_size(64), aligned(8), may_alias));

constexpr std::size_t kPairwiseBlock = 128;
constexpr std::size_t kStep = kLanes;
constexpr std::size_t kMostLag = 10;

const Lanes* At(const double* place) { return reinterpret_cast<const Lanes*>(place); }

double Total(const double* lanes) {
  return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) + ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]));
}

double Total(const Lanes& lanes) { return Total(reinterpret_cast<const double*>(&lanes)); }

STRAINWAVE_VECTOR_CLONES
double SumOfBlock(const double* x, std::size_t n) {
  Lanes sums = *At(x);
  std::size_t i = kStep;
  for (; i + kStep <= n; i += kStep) sums += *At(x + i);
  double sum = Total(sums);
  for (; i < n; ++i) sum += x[i];
  return sum;
}

// ∑ over t of x(t) x(t+l) x(t+2l), and of x(t+2l)² x(t+l) − x(t+l) x(t)².
struct ProductSums {
  double third;
  double asymmetry;
};

STRAINWAVE_VECTOR_CLONES
void AddProducts(const double* x, std::size_t lag, std::size_t count, ProductSums& out) {
  Lanes third{};
  Lanes asymmetry{};
  std::size_t t = 0;
  for (; t + kStep <= count; t += kStep) {
    const Lanes x0 = *At(x + t);
    const Lanes x1 = *At(x + t + lag);
    const Lanes x2 = *At(x + t + 2 * lag);
    third += x2 * x1 * x0;
    asymmetry += x2 * x2 * x1 - x1 * x0 * x0;
  }
  out.third = Total(third);
  out.asymmetry = Total(asymmetry);
  for (; t < count; ++t) {
    const double x0 = x[t];
    const double x1 = x[t + lag];
    const double x2 = x[t + 2 * lag];
    out.third += x2 * x1 * x0;
    out.asymmetry += x2 * x2 * x1 - x1 * x0 * x0;
  }
}

STRAINWAVE_VECTOR_CLONES
void AddSquares(const double* x, std::size_t n, double& squares, double& squared_steps) {
  Lanes of_values{};
  Lanes of_steps{};
  std::size_t t = 0;
  for (; t + kStep < n; t += kStep) {
    const Lanes here = *At(x + t);
    const Lanes step = *At(x + t + 1) - here;
    of_values += here * here;
    of_steps += step * step;
  }
  squares = Total(of_values);
  squared_steps = Total(of_steps);
  for (; t < n; ++t) {
    squares += x[t] * x[t];
    if (t + 1 < n) squared_steps += (x[t + 1] - x[t]) * (x[t + 1] - x[t]);
  }
}

}  // namespace

double PairwiseSum(std::span<const double> x) {
  if (x.size() < kStep) {
    double sum = 0.0;
    for (const double value : x) sum += value;
    return sum;
  }
  if (x.size() <= kPairwiseBlock) return SumOfBlock(x.data(), x.size());
  const std::size_t half = x.size() / 2 / kStep * kStep;
  return PairwiseSum(x.first(half)) + PairwiseSum(x.subspan(half));
}

STRAINWAVE_VECTOR_CLONES
std::size_t CrossingCount(std::span<const double> x, double level) {
  Masks minus_count{};
  const Lanes levels = level - Lanes{};
  std::size_t t = 0;
  for (; t + kStep < x.size(); t += kStep) {
    minus_count += (*At(x.data() + t) > levels) ^ (*At(x.data() + t + 1) > levels);
  }
  long long count = 0;
  for (int lane = 0; lane < kLanes; ++lane) count -= minus_count[lane];
  for (; t + 1 < x.size(); ++t) count += (x[t] > level) != (x[t + 1] > level) ? 1 : 0;
  return static_cast<std::size_t>(count);
}

STRAINWAVE_VECTOR_CLONES
double Shift(std::span<const double> x, double shift, std::span<double> y) {
  Lanes squares{};
  std::size_t t = 0;
  for (; t + kStep <= x.size(); t += kStep) {
    const Lanes shifted = *At(x.data() + t) - shift;
    *reinterpret_cast<Lanes*>(y.data() + t) = shifted;
    squares += shifted * shifted;
  }
  double sum = Total(squares);
  for (; t < x.size(); ++t) {
    y[t] = x[t] - shift;
    sum += y[t] * y[t];
  }
  return sum;
}

NeighbourProducts NeighbourProductsOf(std::span<const double> x) {
  NeighbourProducts products;
  AddSquares(x.data(), x.size(), products.squares, products.squared_steps);
  for (std::size_t lag = 1; lag <= kMostProductLag && 2 * lag < x.size(); ++lag) {
    const std::size_t count = x.size() - 2 * lag;
    ProductSums sums{};
    AddProducts(x.data(), lag, count, sums);
    products.third[lag - 1] = sums.third / static_cast<double>(count);
    products.asymmetry[lag - 1] = sums.asymmetry / static_cast<double>(count);
  }
  return products;
}

STRAINWAVE_VECTOR_CLONES
void LagProducts(std::span<const double> x, std::span<double> out) {
  const std::size_t most_lag = out.size() - 1;
  Lanes sums[kMostLag + 1]{};
  std::size_t t = most_lag;
  // The common number of lags is a constant, so that the sums stay in registers.
  if (most_lag == kMostLag) {
    for (; t + kStep <= x.size(); t += kStep) {
      const Lanes here = *At(x.data() + t);
      for (std::size_t lag = 0; lag <= kMostLag; ++lag) sums[lag] += here * *At(x.data() + t - lag);
    }
  }
  for (std::size_t lag = 0; lag <= most_lag; ++lag) {
    out[lag] = Total(sums[lag]);
    for (std::size_t rest = t; rest < x.size(); ++rest) out[lag] += x[rest] * x[rest - lag];
  }
}

}  // namespace strainwave::analysis::features
