// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/prognostic_features.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "analysis/arguments.h"

namespace strainwave::analysis::reliability {
namespace {

constexpr std::size_t kShares = 100;

double Monotonicity(const std::vector<double>& values) {
  int rises = 0;
  int falls = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    rises += values[i] > values[i - 1];
    falls += values[i] < values[i - 1];
  }
  return std::abs(rises - falls) / static_cast<double>(values.size() - 1);
}

std::vector<double> OverLife(const std::vector<double>& values) {
  std::vector<double> shares;
  for (std::size_t k = 0; k < kShares; ++k) {
    const double at = static_cast<double>(k) / (kShares - 1) * static_cast<double>(values.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(at), values.size() - 2);
    const double part = at - static_cast<double>(i);
    shares.push_back((1.0 - part) * values[i] + part * values[i + 1]);
  }
  return shares;
}

double Correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double mean_a = 0.0;
  double mean_b = 0.0;
  for (std::size_t i = 0; i < kShares; ++i) {
    mean_a += a[i] / kShares;
    mean_b += b[i] / kShares;
  }
  double aa = 0.0, bb = 0.0, ab = 0.0;
  for (std::size_t i = 0; i < kShares; ++i) {
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
    ab += (a[i] - mean_a) * (b[i] - mean_b);
  }
  return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 0.0;
}

}  // namespace

PrognosticWorth WorthOf(std::span<const std::vector<double>> units) {
  if (units.empty()) throw std::invalid_argument("units has 0 values (expected at least 1)");
  const auto n = static_cast<double>(units.size());
  PrognosticWorth worth{0.0, 1.0, 1.0};
  double mean_last = 0.0;
  double mean_way = 0.0;
  std::vector<std::vector<double>> over_life;
  for (const std::vector<double>& values : units) {
    RequireAtLeast("values", values, 2);
    RequireFinite("values", values);
    worth.monotonicity += Monotonicity(values) / n;
    mean_last += values.back() / n;
    mean_way += std::abs(values.front() - values.back()) / n;
    over_life.push_back(OverLife(values));
  }
  if (units.size() < 2) return worth;
  double squares = 0.0;
  for (const std::vector<double>& values : units) squares += std::pow(values.back() - mean_last, 2);
  const double deviation = std::sqrt(squares / (n - 1.0));
  worth.prognosability = mean_way > 0.0 ? std::exp(-deviation / mean_way) : (deviation > 0.0 ? 0.0 : 1.0);
  for (std::size_t i = 0; i < over_life.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j)
      worth.trendability = std::min(worth.trendability, std::abs(Correlation(over_life[i], over_life[j])));
  }
  return worth;
}

}  // namespace strainwave::analysis::reliability
