// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/class_scores.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "analysis/interval_95.h"

namespace strainwave::analysis::prediction {

double AreaUnderCurve(std::span<const int> actual, std::span<const double> score) {
  if (actual.size() != score.size()) throw std::invalid_argument("as many scores as classes are needed");
  std::vector<std::size_t> order(score.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return score[i]; });
  double ranks_of_ones = 0.0;
  double ones = 0.0;
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin;
    while (end < order.size() && score[order[end]] == score[order[begin]]) ++end;
    const double rank = 0.5 * static_cast<double>(begin + end + 1);  // mean of those that are alike, from 1
    for (std::size_t k = begin; k < end; ++k) {
      if (actual[order[k]] != 1) continue;
      ranks_of_ones += rank;
      ones += 1.0;
    }
    begin = end;
  }
  const double zeros = static_cast<double>(score.size()) - ones;
  if (ones == 0.0 || zeros == 0.0) return std::numeric_limits<double>::quiet_NaN();
  return (ranks_of_ones - 0.5 * ones * (ones + 1.0)) / (ones * zeros);
}

ShareInterval WilsonInterval(double hits, double cases) {
  if (!(cases > 0.0 && hits >= 0.0 && hits <= cases))
    throw std::invalid_argument("a share is of one case or more, with at most as many hits");
  constexpr double kNormal = kStandardErrorsOf95;
  const double share = hits / cases;
  const double square = kNormal * kNormal / cases;
  const double middle = (share + 0.5 * square) / (1.0 + square);
  const double half =
      kNormal / (1.0 + square) * std::sqrt(share * (1.0 - share) / cases + 0.25 * square / cases);
  return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

}  // namespace strainwave::analysis::prediction
