// SPDX-License-Identifier: Apache-2.0
#include "analysis/health/component_scores.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <vector>

#include "analysis/statistics/ranks.h"

namespace strainwave::analysis::health {
namespace {

// Rows by the levels of all other components.
std::vector<std::vector<Eigen::Index>> CellsBeside(const Eigen::MatrixXi& levels, Eigen::Index component) {
  std::map<std::vector<int>, std::vector<Eigen::Index>> cells;
  for (Eigen::Index i = 0; i < levels.rows(); ++i) {
    std::vector<int> cell;
    for (Eigen::Index c = 0; c < levels.cols(); ++c) {
      if (c != component) cell.push_back(levels(i, c));
    }
    cells[cell].push_back(i);
  }
  std::vector<std::vector<Eigen::Index>> several;
  for (auto& [cell, rows] : cells) {
    bool differs = false;
    for (const Eigen::Index row : rows)
      differs = differs || levels(row, component) != levels(rows.front(), component);
    if (differs) several.push_back(std::move(rows));
  }
  return several;
}

double FisherRatio(const std::vector<double>& x, const std::vector<int>& level) {
  struct Sums {
    double count{}, sum{}, squares{};
  };
  std::map<int, Sums> of_level;
  double all = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) all += x[i];
  const double mean = all / static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    Sums& sums = of_level[level[i]];
    const double off = x[i] - mean;
    sums.count += 1.0;
    sums.sum += off;
    sums.squares += off * off;
  }
  // Of a constant, only the rounding of its mean would be left.
  const auto [low, high] = std::ranges::minmax(x);
  if (!(high > low)) return 0.0;
  double between = 0.0;
  double within = 0.0;
  for (const auto& [number, sums] : of_level) {
    const double middle = sums.sum / sums.count;
    between += middle * middle;
    within += sums.squares - sums.count * middle * middle;
  }
  if (!(between > 0.0)) return 0.0;
  // Levels that hold one value each would be apart without end.
  constexpr double kRounding = 1e-12;
  return between / std::max(within, kRounding * between);
}

Eigen::VectorXd FromZeroToOne(const Eigen::VectorXd& values) {
  const double low = values.minCoeff();
  const double range = values.maxCoeff() - low;
  if (!(range > 0.0)) return Eigen::VectorXd::Zero(values.size());
  return (values.array() - low) / range;
}

}  // namespace

ComponentScores ScoreFeatures(const Eigen::MatrixXd& features, const Eigen::MatrixXd& health,
                              const Eigen::MatrixXi& levels, Eigen::Index component,
                              const ScoreSettings& settings) {
  if (features.rows() != health.rows() || features.rows() != levels.rows() ||
      health.cols() != levels.cols() || component < 0 || component >= health.cols() || features.cols() < 1)
    throw std::invalid_argument("features, health and levels are not of the same rows and components");
  const std::vector<std::vector<Eigen::Index>> cells = CellsBeside(levels, component);
  const Eigen::Index count = features.cols();
  ComponentScores scores{Eigen::VectorXd::Zero(count), Eigen::VectorXd::Zero(count),
                         Eigen::VectorXd::Zero(count), Eigen::VectorXd::Zero(count),
                         static_cast<int>(cells.size())};
  for (const std::vector<Eigen::Index>& rows : cells) {
    std::vector<double> severity;
    std::vector<int> level;
    for (const Eigen::Index row : rows) {
      severity.push_back(health(row, component));
      level.push_back(levels(row, component));
    }
    const std::vector<double> ranks = statistics::MidRanks(severity);
    std::vector<double> x(rows.size());
    for (Eigen::Index f = 0; f < count; ++f) {
      bool finite = true;
      for (std::size_t i = 0; i < rows.size(); ++i) {
        x[i] = features(rows[i], f);
        finite = finite && std::isfinite(x[i]);
      }
      if (!finite) continue;
      const double correlation = statistics::PearsonCorrelation(statistics::MidRanks(x), ranks);
      scores.correlation(f) += correlation;
      scores.magnitudes(f) += std::abs(correlation);
      scores.fisher(f) += FisherRatio(x, level);
    }
  }
  if (!cells.empty()) {
    const auto number = static_cast<double>(cells.size());
    scores.correlation = scores.correlation.cwiseAbs() / number;
    scores.magnitudes /= number;
    scores.fisher /= number;
  }
  const Eigen::VectorXd& trend = settings.sum_of_magnitudes ? scores.magnitudes : scores.correlation;
  scores.score =
      settings.alpha * FromZeroToOne(trend) + (1.0 - settings.alpha) * FromZeroToOne(scores.fisher);
  return scores;
}

}  // namespace strainwave::analysis::health
