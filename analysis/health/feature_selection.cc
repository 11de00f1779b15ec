// SPDX-License-Identifier: Apache-2.0
#include "analysis/health/feature_selection.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <span>

#include "analysis/statistics/ranks.h"

namespace strainwave::analysis::health {
namespace {

std::span<const double> Column(const Eigen::MatrixXd& features, Eigen::Index f) {
  return {features.col(f).data(), static_cast<std::size_t>(features.rows())};
}

}  // namespace

ScoreThreshold ThresholdOf(const Eigen::VectorXd& score, double rounding) {
  std::map<double, int> counts;
  for (const double value : score) ++counts[rounding > 0.0 ? std::round(value / rounding) * rounding : value];
  ScoreThreshold result;
  for (const auto& [value, count] : counts) {
    result.unique.push_back(value);
    result.frequency.push_back(count);
    result.difference.push_back(
        result.unique.size() < 2 ? 0.0 : (value - result.unique[result.unique.size() - 2]) / count);
  }
  const std::vector<double>& d = result.difference;
  for (std::size_t i = 1; i < d.size(); ++i) {
    const double after = i + 1 < d.size() ? d[i + 1] : 0.0;
    if (d[i] > after && d[i] >= d[i - 1] && d[i] > 0.0 && (i < 2 || d[i] > d[i - 1]))
      result.peaks.push_back(i);
  }
  result.threshold = result.unique.empty() ? 0.0 : result.unique.front();
  constexpr std::size_t kBefore = 3;
  for (std::size_t k = kBefore; k < result.peaks.size(); ++k) {
    double before = 0.0;
    for (std::size_t j = 1; j <= kBefore; ++j)
      before += d[result.peaks[k - j]] / static_cast<double>(kBefore);
    const double rise_percent = 100.0 * (d[result.peaks[k]] - before) / before;
    if (rise_percent > result.rise_percent) {
      result.rise_percent = rise_percent;
      result.threshold = result.unique[result.peaks[k]];
    }
  }
  return result;
}

Selection SelectFeatures(const Eigen::MatrixXd& features, const Eigen::VectorXd& score,
                         const SelectionSettings& settings) {
  Selection selection{ThresholdOf(score, settings.rounding), {}, {}};
  std::vector<Eigen::Index> order(static_cast<std::size_t>(score.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::ranges::stable_sort(order, [&](Eigen::Index a, Eigen::Index b) { return score(a) > score(b); });
  // A score counts by its rounded value, as the threshold does.
  const double least_score = selection.threshold.threshold - 0.5 * settings.rounding;
  for (const Eigen::Index f : order) {
    const bool above = score(f) >= least_score && score(f) > 0.0;
    if (above) selection.above.push_back(f);
    const auto kept = static_cast<int>(selection.kept.size());
    if (!(above || kept < settings.least) || kept >= settings.most || !(score(f) > 0.0)) continue;
    const bool new_to_us = std::ranges::none_of(selection.kept, [&](Eigen::Index other) {
      return std::abs(statistics::PearsonCorrelation(Column(features, f), Column(features, other))) >
             settings.most_correlation;
    });
    if (new_to_us) selection.kept.push_back(f);
  }
  return selection;
}

}  // namespace strainwave::analysis::health
