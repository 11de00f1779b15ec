// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/straight_fit.h"

#include <algorithm>
#include <cmath>

namespace strainwave::analysis::reliability {
namespace {

struct Products {
  double xx{}, xy{}, yy{};
};

// Sums of products of x^power and y, each less its value at a point.
Products ProductsAbout(std::span<const double> x, std::span<const double> y, double power, double at_x,
                       double at_y) {
  Products sums;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = std::pow(x[i], power) - at_x;
    const double dy = y[i] - at_y;
    sums.xx += dx * dx;
    sums.xy += dx * dy;
    sums.yy += dy * dy;
  }
  return sums;
}

}  // namespace

StraightFit FitPower(std::span<const double> x, std::span<const double> y, double power) {
  const auto n = static_cast<double>(x.size());
  double mean_x = 0.0;
  double mean_y = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += std::pow(x[i], power) / n;
    mean_y += y[i] / n;
  }
  const auto [xx, xy, yy] = ProductsAbout(x, y, power, mean_x, mean_y);
  const double slope = xy / xx;
  return {mean_y - slope * mean_x, slope, 1.0 / xx, std::max(yy - slope * xy, 0.0)};
}

double ResidualThrough(std::span<const double> x, std::span<const double> y, double power, double x_met,
                       double y_met) {
  const auto [xx, xy, yy] = ProductsAbout(x, y, power, std::pow(x_met, power), y_met);
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
