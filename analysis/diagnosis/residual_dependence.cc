// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "analysis/diagnosis/residual_views.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

struct Bins {
  std::vector<std::size_t> of_sample;  // bin of each
  std::vector<double> centre;          // mean of the regressor
};

// Up to eight bins of equal count; fewer where the regressor has fewer values than that.
Bins Bin(std::span<const double> values, std::span<const double> weights) {
  constexpr std::size_t kMost = 8;
  std::vector<double> sorted;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (weights[i] > 0.0) sorted.push_back(values[i]);
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<double> upper;  // inclusive
  for (std::size_t b = 1; b <= kMost && !sorted.empty(); ++b) {
    const double edge = sorted[std::max<std::size_t>(1, b * sorted.size() / kMost) - 1];
    if (upper.empty() || edge > upper.back()) upper.push_back(edge);
  }
  Bins bins{std::vector<std::size_t>(values.size(), 0), std::vector<double>(upper.size(), 0.0)};
  std::vector<double> count(upper.size(), 0.0);
  for (std::size_t i = 0; i < values.size() && !upper.empty(); ++i) {
    const auto edge = std::lower_bound(upper.begin(), upper.end() - 1, values[i]);
    const auto bin = static_cast<std::size_t>(edge - upper.begin());
    bins.of_sample[i] = bin;
    if (!(weights[i] > 0.0)) continue;
    bins.centre[bin] += values[i];
    count[bin] += 1.0;
  }
  for (std::size_t b = 0; b < upper.size(); ++b) {
    bins.centre[b] /= std::max(1.0, count[b]);
  }
  return bins;
}

std::string DependenceText(const Regressor& regressor, const std::vector<double>& centre,
                           const Eigen::VectorXd& means, const std::string& unit, double unit_per_si) {
  const TitleParts title = SplitTitle(regressor);
  Index lowest = 0;
  Index highest = 0;
  means.minCoeff(&lowest);
  means.maxCoeff(&highest);
  const Index last = means.size() - 1;
  const auto at = [&](Index bin) {
    return fmt::format("{:+.3g} {} at {:.4g}{}{}", means(bin) * unit_per_si, unit,
                       centre[static_cast<std::size_t>(bin)] * regressor.per_unit,
                       title.unit.empty() ? "" : " ", title.unit);
  };
  if (lowest == 0 && highest == last)
    return fmt::format("rises with {}, {} to {}", title.quantity, at(0), at(last));
  if (highest == 0 && lowest == last)
    return fmt::format("falls with {}, {} to {}", title.quantity, at(0), at(last));
  return fmt::format("depends on {}, lowest {}, highest {}", title.quantity, at(lowest), at(highest));
}

}  // namespace

void AddDependence(const Study& study, const Regressor& regressor, std::span<const double> weights,
                   std::vector<ResidualView>& views) {
  const Bins bins = Bin(regressor.values, weights);
  const auto count = static_cast<Index>(bins.centre.size());
  if (count < 2) return;
  const auto samples = static_cast<Index>(regressor.values.size());
  const double search_locations = count > 2 ? 2.0 : 1.0;  // a straight line, and any curve
  if (count > 2) {
    ResidualView line;
    line.columns.resize(samples, 2);
    const double origin = bins.centre[bins.centre.size() / 2];
    line.columns.col(0).setOnes();
    line.columns.col(1) =
        Eigen::Map<const Eigen::VectorXd>(regressor.values.data(), samples).array() - origin;
    line.degrees_of_freedom = 1;
    line.search_locations = search_locations;
    line.describe = [&regressor, bins, origin, unit = study.unit(),
                     unit_per_si = study.unit_per_si()](const Eigen::VectorXd& line_coefficients) {
      Eigen::VectorXd means(static_cast<Index>(bins.centre.size()));
      for (Index b = 0; b < means.size(); ++b) {
        means(b) =
            line_coefficients(0) + line_coefficients(1) * (bins.centre[static_cast<std::size_t>(b)] - origin);
      }
      return DependenceText(regressor, bins.centre, means, unit, unit_per_si);
    };
    views.push_back(std::move(line));
  }
  ResidualView curve;
  curve.columns = Eigen::MatrixXd::Zero(samples, count);
  for (std::size_t i = 0; i < bins.of_sample.size(); ++i) {
    curve.columns(static_cast<Index>(i), static_cast<Index>(bins.of_sample[i])) = 1.0;
  }
  curve.degrees_of_freedom = static_cast<int>(count) - 1;
  curve.search_locations = search_locations;
  curve.describe = [&regressor, centre = bins.centre, unit = study.unit(),
                    unit_per_si = study.unit_per_si()](const Eigen::VectorXd& means) {
    return DependenceText(regressor, centre, means, unit, unit_per_si);
  };
  views.push_back(std::move(curve));
}

}  // namespace strainwave::analysis::diagnosis
