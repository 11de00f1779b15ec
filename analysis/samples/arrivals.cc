// SPDX-License-Identifier: Apache-2.0
#include "analysis/samples/arrivals.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "analysis/noise_level.h"

namespace strainwave::analysis::samples {
namespace {

std::vector<std::size_t> RowsOf(const std::vector<bool>& marked) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < marked.size(); ++i) {
    if (marked[i]) rows.push_back(i);
  }
  return rows;
}

}  // namespace

std::vector<double> ArrivalTimes(std::span<const double> time_s, const std::vector<bool>& fresh) {
  constexpr double kEvenWithin = 1.3;  // rows, between the earliest and the latest
  std::vector<double> arrival_s(time_s.begin(), time_s.end());
  const std::vector<std::size_t> rows = RowsOf(fresh);
  if (rows.size() < 3) return arrival_s;
  std::vector<double> steps;
  for (std::size_t i = 1; i < time_s.size(); ++i) steps.push_back(time_s[i] - time_s[i - 1]);
  const double row_s = Median(std::move(steps));
  const double middle = 0.5 * static_cast<double>(rows.size() - 1);
  double mean_s = 0.0;
  double along = 0.0;
  double squares = 0.0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double offset = static_cast<double>(k) - middle;
    mean_s += time_s[rows[k]] / static_cast<double>(rows.size());
    along += offset * time_s[rows[k]];
    squares += offset * offset;
  }
  const auto even_s = [&](std::size_t k) {
    return mean_s + along / squares * (static_cast<double>(k) - middle);
  };
  double early_s = 0.0;
  double late_s = 0.0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    early_s = std::min(early_s, time_s[rows[k]] - even_s(k));
    late_s = std::max(late_s, time_s[rows[k]] - even_s(k));
  }
  const bool between_rows = late_s - early_s > 0.1 * row_s && late_s - early_s <= kEvenWithin * row_s;
  if (!between_rows) return arrival_s;
  for (std::size_t k = 0; k < rows.size(); ++k) arrival_s[rows[k]] = even_s(k) - 0.5 * row_s;
  return arrival_s;
}

std::vector<double> AtArrivals(std::span<const double> time_s, std::span<const double> values,
                               const std::vector<bool>& own, std::span<const double> arrival_s,
                               const std::vector<bool>& wanted) {
  std::vector<double> at(values.begin(), values.end());
  const std::vector<std::size_t> rows = RowsOf(own);
  if (rows.size() < 2) return at;
  std::size_t k = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!wanted[i]) continue;
    while (k + 2 < rows.size() && time_s[rows[k + 1]] <= arrival_s[i]) ++k;
    const double from_s = time_s[rows[k]];
    const double step_s = time_s[rows[k + 1]] - from_s;
    const double share = step_s > 0.0 ? std::clamp((arrival_s[i] - from_s) / step_s, 0.0, 1.0) : 0.0;
    at[i] = values[rows[k]] + share * (values[rows[k + 1]] - values[rows[k]]);
  }
  return at;
}

}  // namespace strainwave::analysis::samples
