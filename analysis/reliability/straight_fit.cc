// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/straight_fit.h"

#include <algorithm>
#include <cmath>

namespace strainwave::analysis::reliability {

StraightFit FitPower(std::span<const double> x, std::span<const double> y, double power) {
  const auto n = static_cast<double>(x.size());
  double mean_x = 0.0;
  double mean_y = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += std::pow(x[i], power) / n;
    mean_y += y[i] / n;
  }
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = std::pow(x[i], power) - mean_x;
    const double dy = y[i] - mean_y;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
  const double slope = xy / xx;
  return {mean_y - slope * mean_x, slope, 1.0 / xx, std::max(yy - slope * xy, 0.0)};
}

double ResidualThrough(std::span<const double> x, std::span<const double> y, double power, double x_met,
                       double y_met) {
  const double met = std::pow(x_met, power);
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = std::pow(x[i], power) - met;
    const double dy = y[i] - y_met;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
  return std::max(yy - xy * xy / xx, 0.0);
}

double EffectiveCount(std::span<const double> x, std::span<const double> y, double power) {
  const StraightFit fit = FitPower(x, y, power);
  double before = 0.0;
  double products = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double residual = y[i] - fit.intercept - fit.slope * std::pow(x[i], power);
    products += i > 0 ? before * residual : 0.0;
    squares += residual * residual;
    before = residual;
  }
  const double r = squares > 0.0 ? std::clamp(products / squares, 0.0, 0.95) : 0.0;
  return static_cast<double>(x.size()) * (1.0 - r) / (1.0 + r);
}

}  // namespace strainwave::analysis::reliability
