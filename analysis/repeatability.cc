// SPDX-License-Identifier: Apache-2.0
#include "analysis/repeatability.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <stdexcept>

#include "analysis/arguments.h"

namespace strainwave::analysis {
namespace {

double TwoSidedT95(double degrees_of_freedom) {
  return boost::math::quantile(boost::math::students_t(degrees_of_freedom), 0.975);
}

}  // namespace

Repeatability EstimateRepeatability(std::span<const std::vector<double>> groups) {
  double total = 0.0;
  double count = 0.0;
  double count_squares = 0.0;
  double group_count = 0.0;
  for (const std::vector<double>& group : groups) {
    RequireFinite("repeats", group);
    const auto size = static_cast<double>(group.size());
    for (double value : group) {
      total += value;
    }
    count += size;
    count_squares += size * size;
    group_count += group.empty() ? 0.0 : 1.0;
  }
  const double within_freedom = count - group_count;
  if (!(within_freedom >= 1.0)) {
    throw std::invalid_argument("repeats: no group has two values (expected one at least)");
  }
  Repeatability result;
  result.mean = total / count;
  result.degrees_of_freedom = within_freedom;
  double within = 0.0;
  double between = 0.0;
  for (const std::vector<double>& group : groups) {
    if (group.empty()) {
      continue;
    }
    double mean = 0.0;
    for (double value : group) {
      mean += value / static_cast<double>(group.size());
    }
    for (double value : group) {
      within += (value - mean) * (value - mean);
    }
    between += static_cast<double>(group.size()) * (mean - result.mean) * (mean - result.mean);
  }
  const double within_variance = within / within_freedom;
  result.repeatability_sd = std::sqrt(within_variance);
  if (group_count > 1.0) {
    const double effective_size = (count - count_squares / count) / (group_count - 1.0);
    const double between_variance = (between / (group_count - 1.0) - within_variance) / effective_size;
    result.reproducibility_sd = std::sqrt(std::max(0.0, between_variance));
  }
  result.gauge_sd = std::hypot(result.repeatability_sd, result.reproducibility_sd);
  result.limit_95 = TwoSidedT95(within_freedom) * std::sqrt(2.0) * result.repeatability_sd;
  return result;
}

Repeatability EstimateRepeatability(std::span<const double> repeats) {
  const std::vector<double> group(repeats.begin(), repeats.end());
  return EstimateRepeatability({&group, 1});
}

bool IsLargerThanGauge(double change, const Repeatability& gauge, std::size_t count_before,
                       std::size_t count_after) {
  RequireFinite("change", change);
  if (count_before == 0 || count_after == 0) {
    throw std::invalid_argument(fmt::format("count_before = {}, count_after = {} (expected at least 1 each)",
                                            count_before, count_after));
  }
  const double share = 1.0 / static_cast<double>(count_before) + 1.0 / static_cast<double>(count_after);
  return std::abs(change) > TwoSidedT95(gauge.degrees_of_freedom) * gauge.repeatability_sd * std::sqrt(share);
}

}  // namespace strainwave::analysis
