// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/fit_covariance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "analysis/decompositions.h"
#include "analysis/diagnosis/noise_likelihood.h"
#include "analysis/interval_95.h"

namespace strainwave::analysis::diagnosis {

using Eigen::Index;
namespace {

// Of the largest eigenvalue of unit columns' products: below it stands rounding alone.
constexpr double kDetermined = 1e-12;

// Rows filtered backwards in time by 1 / A(z) within each segment: Σ = σ² A⁻¹ A⁻ᵀ, so that JᵀΣJ is σ² times
// the square of A⁻ᵀ J.
Eigen::MatrixXd ColourBackwards(Eigen::MatrixXd rows, const NoiseFit& noise,
                                std::span<const std::size_t> segments) {
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const auto first = static_cast<Index>(segments[s]);
    const Index last = s + 1 < segments.size() ? static_cast<Index>(segments[s + 1]) : rows.rows();
    for (Index i = last - 1; i >= first; --i) {
      for (Index k = 1; k <= noise.order && i + k < last; ++k) {
        rows.row(i) += noise.series.front().coefficients[static_cast<std::size_t>(k - 1)] * rows.row(i + k);
      }
    }
  }
  return rows;
}

// Directions whose change moves no sample, as far as rounding lets that be seen; of unit columns.
Eigen::MatrixXd OpenDirections(const Eigen::MatrixXd& columns, const Eigen::VectorXd& ridge) {
  constexpr double kRounding = 1e-4;  // of a parameter's share in a direction
  Eigen::MatrixXd gram = columns.transpose() * columns;
  gram.diagonal() += ridge;
  const SymmetricParts eigen = SymmetricEigen(gram);
  const double least = kDetermined * std::max(eigen.values.maxCoeff(), 1e-300);
  const Index count = (eigen.values.array() <= least).count();
  const Eigen::MatrixXd open = eigen.vectors.leftCols(count);  // the values rise
  return (open.array().abs() > kRounding).select(open, 0.0);
}

}  // namespace

FitErrors ErrorsOfFit(const Eigen::MatrixXd& sensitivities, std::span<const double> measured,
                      const Eigen::VectorXd& predicted, std::span<const double> weights,
                      std::span<const std::size_t> segments, int largest_noise_order,
                      const Eigen::VectorXd& ridge) {
  const Index p = sensitivities.cols();
  std::vector<double> residual(measured.begin(), measured.end());
  Eigen::MatrixXd used = sensitivities;
  double square_sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    residual[i] -= predicted(static_cast<Index>(i));
    if (weights[i] > 0.0) {
      square_sum += weights[i] * residual[i] * residual[i];
      count += 1.0;
    }
    used.row(static_cast<Index>(i)) *= std::sqrt(weights[i]);
  }
  // Columns of one size: parameters in radians and in turns share a matrix.
  Eigen::VectorXd scale(p);
  for (Index j = 0; j < p; ++j) {
    const double norm = used.col(j).norm();
    scale(j) = norm > 0.0 ? 1.0 / norm : 1.0;
    used.col(j) *= scale(j);
  }
  const NoiseFit noise =
      FitNoise(residual, weights, segments, largest_noise_order, std::max(std::sqrt(square_sum), 1e-300));
  const SymmetricParts eigen = SymmetricEigen(used.transpose() * used);
  const double least = kDetermined * std::max(eigen.values.maxCoeff(), 1e-300);
  const Eigen::MatrixXd bread =
      eigen.vectors * eigen.InverseAbove(least).asDiagonal() * eigen.vectors.transpose();
  const double freedom = std::max(1.0, count - static_cast<double>(p));
  Eigen::MatrixXd covariance = square_sum / freedom * bread;
  if (noise.order > 0) {
    const Eigen::MatrixXd coloured = ColourBackwards(used, noise, segments);
    covariance = noise.innovation_sd * noise.innovation_sd * count / freedom *
                 (bread * (coloured.transpose() * coloured) * bread);
  }
  return {scale.asDiagonal() * covariance * scale.asDiagonal(),
          scale.asDiagonal() * OpenDirections(used, scale.cwiseAbs2().cwiseProduct(ridge))};
}

double StandardErrorOver(std::span<const Believed> models) {
  constexpr double kShare = 0.95;
  double all = 0.0;
  double farthest = 0.0;
  if (!std::isfinite(models[0].standard_error)) return models[0].standard_error;
  for (const Believed& model : models) {
    all += model.likelihood;
    if (!std::isfinite(model.standard_error)) continue;
    farthest = std::max(farthest, std::abs(model.value - models[0].value) + 10.0 * model.standard_error);
  }
  const auto share_within = [&](double reach) {
    double share = 0.0;
    for (const Believed& model : models) {
      if (!std::isfinite(model.standard_error)) continue;
      // One that is known exactly is within or beyond.
      const double width = std::numbers::sqrt2 * std::max(model.standard_error, 1e-12 * farthest);
      const double off = model.value - models[0].value;
      share +=
          0.5 * model.likelihood / all * (std::erf((reach - off) / width) + std::erf((reach + off) / width));
    }
    return share;
  };
  if (share_within(farthest) < kShare) return std::numeric_limits<double>::infinity();
  double below = 0.0;
  double above = farthest;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (below + above);
    (share_within(middle) < kShare ? below : above) = middle;
  }
  return above / kStandardErrorsOf95;
}

void WidenErrors(std::span<const OtherModel> others, std::vector<ParameterValue>& numbers) {
  for (ParameterValue& number : numbers) {
    std::vector<Believed> believed{{1.0, number.value, number.standard_error}};
    for (const OtherModel& other : others) {
      const auto same = std::ranges::find(other.numbers, number.name, &ParameterValue::name);
      if (same != other.numbers.end())
        believed.push_back({other.likelihood, same->value, same->standard_error});
    }
    if (believed.size() > 1) number.standard_error = StandardErrorOver(believed);
  }
}

}  // namespace strainwave::analysis::diagnosis
