// SPDX-License-Identifier: Apache-2.0
#include "analysis/features/autoregression.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <limits>
#include <optional>

#include "analysis/features/sums.h"

namespace strainwave::analysis::features {
namespace {

constexpr int kOrder = kAutoregressiveOrder;
constexpr int kUnknowns = kOrder + 1;

using Square = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
using Coefficients = std::array<double, kUnknowns>;

struct LagMoments {
  Square products;  // (a, b): ∑ x(t−a) x(t−b)
  Unknowns sums;    // a: ∑ x(t−a)
};

// Moving both lags by one changes the sum by what enters and leaves the window.
LagMoments LagMomentsOf(std::span<const double> x) {
  LagMoments moments;
  Coefficients first{};
  LagProducts(x, first);
  const std::size_t n = x.size();
  for (std::size_t b = 0; b < kUnknowns; ++b) {
    double product = first[b];
    for (std::size_t a = 0; a + b < kUnknowns; ++a) {
      const auto row = static_cast<Eigen::Index>(a);
      const auto column = static_cast<Eigen::Index>(a + b);
      moments.products(row, column) = moments.products(column, row) = product;
      if (a + b < kOrder)
        product += x[kOrder - 1 - a] * x[kOrder - 1 - a - b] - x[n - 1 - a] * x[n - 1 - a - b];
    }
  }
  double sum = PairwiseSum(x.subspan(kOrder));
  for (std::size_t a = 0; a < kUnknowns; ++a) {
    moments.sums(static_cast<Eigen::Index>(a)) = sum;
    if (a < kOrder) sum += x[kOrder - 1 - a] - x[n - 1 - a];
  }
  return moments;
}

// The unknowns of the centred series, or nothing where the equations are too close to singular.
std::optional<Unknowns> SolveNormalEquations(std::span<const double> centred) {
  const LagMoments moments = LagMomentsOf(centred);
  Square matrix;
  Unknowns right;
  matrix(0, 0) = static_cast<double>(centred.size() - kOrder);
  matrix.block<1, kOrder>(0, 1) = moments.sums.tail<kOrder>().transpose();
  matrix.block<kOrder, 1>(1, 0) = moments.sums.tail<kOrder>();
  matrix.block<kOrder, kOrder>(1, 1) = moments.products.block<kOrder, kOrder>(1, 1);
  right(0) = moments.sums(0);
  right.tail<kOrder>() = moments.products.block<kOrder, 1>(1, 0);
  const Unknowns scale = matrix.diagonal().cwiseSqrt();
  if (!(scale.minCoeff() > 0.0)) return std::nullopt;
  const Square scaled = scale.cwiseInverse().asDiagonal() * matrix * scale.cwiseInverse().asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> cholesky(scaled);
  // Rounding of the products grows by the condition: this leaves about ten digits.
  constexpr double kWellConditioned = 1e-5;
  if (cholesky.info() != Eigen::Success || !(cholesky.rcond() > kWellConditioned)) return std::nullopt;
  return Unknowns(cholesky.solve(right.cwiseQuotient(scale).eval()).cwiseQuotient(scale));
}

// Least squares on the rows themselves: QR of a block of rows below the triangle of those before.
Unknowns SolveByRows(std::span<const double> x) {
  constexpr std::size_t kRows = 256;
  using Stack = Eigen::Matrix<double, kUnknowns + 1 + static_cast<int>(kRows), kUnknowns + 1>;
  Stack stack = Stack::Zero();
  for (std::size_t begin = kOrder; begin < x.size(); begin += kRows) {
    const std::size_t count = std::min(kRows, x.size() - begin);
    stack.bottomRows<kRows>().setZero();
    for (std::size_t i = 0; i < count; ++i) {
      const auto row = static_cast<Eigen::Index>(kUnknowns + 1 + i);
      stack(row, 0) = 1.0;
      for (std::size_t lag = 1; lag <= kOrder; ++lag) {
        stack(row, static_cast<Eigen::Index>(lag)) = x[begin + i - lag];
      }
      stack(row, kUnknowns) = x[begin + i];
    }
    const Eigen::HouseholderQR<Stack> qr(stack);
    stack.topRows<kUnknowns + 1>() =
        qr.matrixQR().topRows<kUnknowns + 1>().triangularView<Eigen::Upper>().toDenseMatrix();
  }
  // Squares that overflow leave no number, on which the decomposition reads what it never computed.
  if (!stack.topRows<kUnknowns>().allFinite())
    return Unknowns::Constant(std::numeric_limits<double>::quiet_NaN());
  Eigen::JacobiSVD<Square> svd(stack.block<kUnknowns, kUnknowns>(0, 0),
                               Eigen::ComputeFullU | Eigen::ComputeFullV);
  svd.setThreshold(1e-15);
  return svd.solve(stack.block<kUnknowns, 1>(0, kUnknowns));
}

}  // namespace

Coefficients AutoregressiveCoefficients(std::span<const double> x, std::span<const double> centred,
                                        double mean) {
  std::optional<Unknowns> solved = SolveNormalEquations(centred);
  if (solved) {
    (*solved)(0) += mean * (1.0 - solved->tail<kOrder>().sum());
  } else {
    solved = SolveByRows(x);
  }
  Coefficients coefficients{};
  std::copy_n(solved->data(), kUnknowns, coefficients.begin());
  return coefficients;
}

}  // namespace strainwave::analysis::features
