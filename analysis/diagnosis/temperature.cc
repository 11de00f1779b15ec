// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/temperature.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cstddef>
#include <numeric>

namespace strainwave::analysis::diagnosis {
namespace {

constexpr std::size_t kBins = 200;
constexpr std::size_t kReach = 10;  // bins to either side

}  // namespace

std::vector<double> SlowTemperature(std::span<const double> temperature_degC) {
  const std::size_t n = temperature_degC.size();
  const std::size_t bins = std::min(n, kBins);
  if (bins <= 2 * kReach) return {temperature_degC.begin(), temperature_degC.end()};
  const auto first_of = [&](std::size_t bin) { return bin * n / bins; };
  const auto middle_of = [&](std::size_t bin) {
    return 0.5 * static_cast<double>(first_of(bin) + first_of(bin + 1) - 1);
  };
  std::vector<double> means;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const auto own = temperature_degC.subspan(first_of(bin), first_of(bin + 1) - first_of(bin));
    means.push_back(std::reduce(own.begin(), own.end()) / static_cast<double>(own.size()));
  }
  const double width = static_cast<double>(n) / static_cast<double>(bins);
  std::vector<double> slow;
  slow.reserve(n);
  for (std::size_t bin = 0; bin < bins; ++bin) {
    // As far inwards as outwards is missing, so that the ends are as smooth as the rest.
    const std::size_t from = std::min(bin - std::min(bin, kReach), bins - 2 * kReach - 1);
    Eigen::Matrix<double, 2 * kReach + 1, 3> powers;
    Eigen::Matrix<double, 2 * kReach + 1, 1> values;
    for (std::size_t b = 0; b < 2 * kReach + 1; ++b) {
      const double x = (middle_of(from + b) - middle_of(bin)) / width;
      powers.row(static_cast<Eigen::Index>(b)) << 1.0, x, x * x;
      values(static_cast<Eigen::Index>(b)) = means[from + b];
    }
    const Eigen::Vector3d parabola = powers.colPivHouseholderQr().solve(values);
    for (std::size_t i = first_of(bin); i < first_of(bin + 1); ++i) {
      const double x = (static_cast<double>(i) - middle_of(bin)) / width;
      slow.push_back(parabola(0) + x * (parabola(1) + x * parabola(2)));
    }
  }
  return slow;
}

}  // namespace strainwave::analysis::diagnosis
