// SPDX-License-Identifier: Apache-2.0
#include "analysis/harmonic_regression.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "analysis/arguments.h"
#include "analysis/units.h"

namespace strainwave::analysis {
namespace {

void RequireArguments(std::span<const double> angle_rad, std::span<const double> values,
                      std::span<const double> orders) {
  RequireSameLength("angle_rad", angle_rad, "values", values);
  RequireFinite("angle_rad", angle_rad);
  RequireFinite("values", values);
  for (double order : orders) {
    RequirePositive("order", order);
  }
  RequireAtLeast("values", values, 2 * orders.size() + 2);
}

Harmonic MakeHarmonic(double order, const LinearFit& fit, Eigen::Index column) {
  const double c = fit.coefficients(column);
  const double s = fit.coefficients(column + 1);
  Harmonic harmonic{
      .order = order, .amplitude = {std::hypot(c, s), 0.0}, .phase_rad = {std::atan2(s, c), kPi}};
  const auto covariance = fit.covariance.block<2, 2>(column, column);
  if (harmonic.amplitude.value > 0.0) {
    const Eigen::Vector2d along = Eigen::Vector2d(c, s) / harmonic.amplitude.value;
    const Eigen::Vector2d across(-along(1), along(0));
    harmonic.amplitude.standard_error = std::sqrt(std::max(0.0, along.dot(covariance * along)));
    const double across_error = std::sqrt(std::max(0.0, across.dot(covariance * across)));
    harmonic.phase_rad.standard_error = std::min(kPi, across_error / harmonic.amplitude.value);
  } else {
    harmonic.amplitude.standard_error = std::sqrt(std::max(0.0, 0.5 * covariance.trace()));
  }
  return harmonic;
}

}  // namespace

HarmonicFit FitHarmonics(std::span<const double> angle_rad, std::span<const double> values,
                         std::span<const double> orders, ErrorModel errors) {
  RequireArguments(angle_rad, values, orders);
  const auto n = static_cast<Eigen::Index>(values.size());
  Eigen::MatrixXd design(n, static_cast<Eigen::Index>(2 * orders.size() + 1));
  for (Eigen::Index row = 0; row < n; ++row) {
    design(row, 0) = 1.0;
    for (std::size_t k = 0; k < orders.size(); ++k) {
      const double angle = orders[k] * angle_rad[static_cast<std::size_t>(row)];
      const auto column = static_cast<Eigen::Index>(2 * k + 1);
      design(row, column) = std::cos(angle);
      design(row, column + 1) = std::sin(angle);
    }
  }
  const LinearFit linear = FitLinear(design, Eigen::Map<const Eigen::VectorXd>(values.data(), n), errors);
  HarmonicFit fit;
  fit.constant = {linear.coefficients(0), linear.StandardError(0)};
  for (std::size_t k = 0; k < orders.size(); ++k) {
    fit.harmonics.push_back(MakeHarmonic(orders[k], linear, static_cast<Eigen::Index>(2 * k + 1)));
  }
  fit.residuals.assign(linear.residuals.begin(), linear.residuals.end());
  fit.residual_standard_deviation = linear.residual_standard_deviation;
  return fit;
}

double HarmonicValue(const HarmonicFit& fit, double angle_rad) {
  double value = fit.constant.value;
  for (const Harmonic& harmonic : fit.harmonics) {
    value += harmonic.amplitude.value * std::cos(harmonic.order * angle_rad - harmonic.phase_rad.value);
  }
  return value;
}

double FoldedOrder(double order, double samples_per_rev) {
  return std::abs(order - samples_per_rev * std::round(order / samples_per_rev));
}

std::vector<double> IntegerOrderSpectrum(std::span<const double> angle_rad, std::span<const double> values,
                                         int max_order) {
  RequireSameLength("angle_rad", angle_rad, "values", values);
  RequireFinite("angle_rad", angle_rad);
  RequireFinite("values", values);
  RequireAtLeast("values", values, 4);
  const auto [low, high] = std::minmax_element(angle_rad.begin(), angle_rad.end());
  const double step_rad = (*high - *low) / static_cast<double>(angle_rad.size() - 1);
  const double nyquist = step_rad > 0.0 ? kPi / step_rad : 0.0;
  // The line at Nyquist itself has no phase of its own.
  const int last =
      std::clamp(static_cast<int>(std::ceil(nyquist * (1.0 - 1e-6))) - 1, 0, std::max(0, max_order));

  double mean = 0.0;
  for (double value : values) {
    mean += value;
  }
  mean /= static_cast<double>(values.size());
  std::vector<std::complex<double>> sums(static_cast<std::size_t>(last) + 1);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::complex<double> turn(std::cos(angle_rad[i]), -std::sin(angle_rad[i]));
    std::complex<double> phasor(1.0, 0.0);
    for (std::size_t order = 1; order < sums.size(); ++order) {
      phasor *= turn;
      sums[order] += (values[i] - mean) * phasor;
    }
  }
  std::vector<double> amplitudes(sums.size());
  amplitudes[0] = std::abs(mean);
  for (std::size_t order = 1; order < sums.size(); ++order) {
    amplitudes[order] = 2.0 * std::abs(sums[order]) / static_cast<double>(values.size());
  }
  return amplitudes;
}

}  // namespace strainwave::analysis
