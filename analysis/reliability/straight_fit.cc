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

}  // namespace strainwave::analysis::reliability
