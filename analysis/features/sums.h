// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>

/// Sums over a series in one pass each. Their order of addition is fixed: the same series gives the same
/// bits.
namespace strainwave::analysis::features {

/// Sum by halves down to blocks of 128, each in eight running sums, as NumPy adds: the mean comes out to the
/// same bit, on which counts of crossings through it depend.
double PairwiseSum(std::span<const double> x);

/// Changes between x > level and x ≤ level.
std::size_t CrossingCount(std::span<const double> x, double level);

/// y = x − shift; returns ∑ y².
double Shift(std::span<const double> x, double shift, std::span<double> y);

inline constexpr std::size_t kMostProductLag = 3;

/// Means of products of neighbours; by index lag − 1, 0 where 2 lag ≥ n.
struct NeighbourProducts {
  double squares{};                                 // ∑ x²
  double squared_steps{};                           // ∑ (x(t+1) − x(t))²
  std::array<double, kMostProductLag> third{};      // mean of x(t) x(t+l) x(t+2l)
  std::array<double, kMostProductLag> asymmetry{};  // mean of x(t+2l)² x(t+l) − x(t+l) x(t)²
};
NeighbourProducts NeighbourProductsOf(std::span<const double> x);

/// out[lag] = ∑ x(t) x(t − lag) over t = most_lag … n − 1, for lag = 0 … most_lag = out.size() − 1 ≤ 10 < n.
void LagProducts(std::span<const double> x, std::span<double> out);

}  // namespace strainwave::analysis::features
