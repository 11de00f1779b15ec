// SPDX-License-Identifier: Apache-2.0
#include "analysis/features/langevin.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>

#include "analysis/features/bins.h"

namespace strainwave::analysis::features {
namespace {

constexpr std::size_t kBins = 30;
constexpr int kDegree = 3;
constexpr double kNotEstimable = std::numeric_limits<double>::quiet_NaN();

using Cubic = std::array<double, kDegree + 1>;  // from the constant up
using Edges = std::array<double, kBins + 1>;

// Edges of bins of equal count over all values but the last of the series.
Edges BinEdges(std::span<const double> x, SortedSeries& sorted) {
  const std::size_t skipped = sorted.CountBelow(x.back());
  const auto at = [&](std::size_t k) { return sorted.At(k < skipped ? k : k + 1); };
  Edges edges{};
  for (std::size_t i = 0; i <= kBins; ++i) {
    // In the reference's arithmetic: an edge that falls on a value, or just misses it, must do so here too.
    const double share = i == kBins ? 1.0 : static_cast<double>(i) * (1.0 / kBins);
    edges[i] = Quantile(x.size() - 1, share, at);
  }
  return edges;
}

struct BinSums {
  std::array<double, kBins> count{};
  std::array<double, kBins> values{};
  std::array<double, kBins> steps{};
};

// A bin holds its upper edge, the first both.
void AddToBins(std::span<const double> x, const Edges& edges, BinSums& sums) {
  constexpr std::size_t kBlock = 512;
  std::array<std::int64_t, kBlock> bins{};
  const auto inner = std::span(edges).subspan<1, kBins - 1>();
  for (std::size_t begin = 0; begin + 1 < x.size(); begin += kBlock) {
    const std::size_t count = std::min(kBlock, x.size() - 1 - begin);
    CountEdgesBelow(x.subspan(begin, count), inner, bins);
    for (std::size_t i = 0; i < count; ++i) {
      const auto bin = static_cast<std::size_t>(bins[i]);
      const double here = x[begin + i];
      sums.count[bin] += 1.0;
      sums.values[bin] += here;
      sums.steps[bin] += x[begin + i + 1] - here;
    }
  }
}

// Least squares on powers of equal norm; too few points give the cubic of least norm.
bool FitCubic(const BinSums& sums, Cubic& cubic) {
  Eigen::Matrix<double, Eigen::Dynamic, kDegree + 1, 0, kBins> powers(kBins, kDegree + 1);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kBins> steps(kBins);
  Eigen::Index points = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    if (sums.count[bin] == 0.0) continue;
    const double value = sums.values[bin] / sums.count[bin];
    double power = 1.0;
    for (int k = 0; k <= kDegree; ++k, power *= value) powers(points, k) = power;
    steps(points) = sums.steps[bin] / sums.count[bin];
    ++points;
  }
  const Eigen::Matrix<double, 1, kDegree + 1> scale = powers.topRows(points).colwise().norm();
  if (points == 0 || !(scale.minCoeff() > 0.0) || !scale.allFinite()) return false;
  const Eigen::MatrixXd scaled = powers.topRows(points) * scale.cwiseInverse().asDiagonal();
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(scaled, Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(static_cast<double>(points) * std::numeric_limits<double>::epsilon());
  const Eigen::VectorXd solution = svd.solve(steps.head(points).eval());
  for (int k = 0; k <= kDegree; ++k) cubic[static_cast<std::size_t>(k)] = solution(k) / scale(k);
  return solution.allFinite();
}

std::complex<double> Polish(std::complex<double> root, const Cubic& cubic) {
  for (int step = 0; step < 3; ++step) {
    const std::complex<double> value = ((cubic[3] * root + cubic[2]) * root + cubic[1]) * root + cubic[0];
    const std::complex<double> slope = (3.0 * cubic[3] * root + 2.0 * cubic[2]) * root + cubic[1];
    const std::complex<double> better = root - value / slope;
    const std::complex<double> left =
        ((cubic[3] * better + cubic[2]) * better + cubic[1]) * better + cubic[0];
    if (!(std::abs(left) < std::abs(value))) break;
    root = better;
  }
  return root;
}

double LargestRealPart(const Cubic& cubic) {
  int lowest = 0;
  int highest = kDegree;
  while (highest >= 0 && cubic[static_cast<std::size_t>(highest)] == 0.0) --highest;
  if (highest < 0) return kNotEstimable;
  while (cubic[static_cast<std::size_t>(lowest)] == 0.0) ++lowest;
  double largest = lowest > 0 ? 0.0 : -std::numeric_limits<double>::infinity();
  const int degree = highest - lowest;
  if (degree == 0) return lowest > 0 ? 0.0 : kNotEstimable;
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(degree, degree);
  companion.diagonal(-1).setOnes();
  for (int k = 0; k < degree; ++k) {
    companion(0, k) =
        -cubic[static_cast<std::size_t>(highest - 1 - k)] / cubic[static_cast<std::size_t>(highest)];
  }
  if (!companion.allFinite()) return kNotEstimable;
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(companion, false);
  if (solver.info() != Eigen::Success) return kNotEstimable;
  for (const std::complex<double>& root : solver.eigenvalues()) {
    largest = std::max(largest, Polish(root, cubic).real());
  }
  return largest;
}

}  // namespace

double LargestLangevinFixedPoint(std::span<const double> x, SortedSeries& sorted) {
  if (x.size() < 2) return kNotEstimable;
  const Edges edges = BinEdges(x, sorted);
  for (std::size_t i = 0; i < kBins; ++i) {
    if (!(edges[i] < edges[i + 1])) return kNotEstimable;
  }
  BinSums sums;
  AddToBins(x, edges, sums);
  Cubic cubic{};
  return FitCubic(sums, cubic) ? LargestRealPart(cubic) : kNotEstimable;
}

}  // namespace strainwave::analysis::features
