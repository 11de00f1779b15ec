// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "analysis/decompositions.h"
#include "analysis/diagnosis/noise_likelihood.h"
#include "analysis/diagnosis/residual_tests.h"
#include "analysis/diagnosis/residual_views.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

// The parts of a view's fit that decide between views.
struct Judged {
  const ResidualView* view{};
  Eigen::VectorXd coefficients;
  Eigen::VectorXd fitted;
  double score{};
  double p_value{1.0};
};

Eigen::VectorXd Project(const Eigen::MatrixXd& columns, const Eigen::VectorXd& residual,
                        std::span<const double> weights, Eigen::VectorXd* coefficients) {
  const Eigen::Map<const Eigen::VectorXd> w(weights.data(), static_cast<Eigen::Index>(weights.size()));
  const Eigen::MatrixXd gram = columns.transpose() * w.asDiagonal() * columns;
  const Eigen::VectorXd right = columns.transpose() * w.cwiseProduct(residual);
  *coefficients = ShortestLeastSquares(gram, right);
  return columns * *coefficients;
}

std::string PText(double p) { return p < 1e-12 ? "p < 1e-12" : fmt::format("p = {:.1g}", p); }

}  // namespace

std::string DescribeResidual(const Study& study, const Eigen::VectorXd& residual,
                             std::span<const double> weights, const ParallelFor& parallel) {
  constexpr double kReported = 1e-3;
  constexpr std::size_t kMost = 3;
  // A view further down the list has to be clearly better: over time a line appears as over an evenly run
  // angle.
  constexpr double kMoreThanAnother = 6.0;
  Eigen::VectorXd left = residual;
  std::string text;
  for (std::size_t round = 0; round < kMost; ++round) {
    const std::span<const double> samples(left.data(), static_cast<std::size_t>(left.size()));
    const double scale = std::sqrt(left.squaredNorm() / std::max(1.0, static_cast<double>(left.size())));
    const auto noise_of = [&](std::span<const double> x) {
      return FitNoise(x, weights, study.segments(), study.LargestNoiseOrder(), scale);
    };
    const NoiseFit before = noise_of(samples);
    if (before.samples < 30 || !(scale > 0.0)) break;
    const std::vector<ResidualView> views = ResidualViewsOf(study, samples, weights, before, parallel);
    std::vector<Judged> all(views.size());
    parallel(views.size(), [&](std::size_t i) {
      const ResidualView& view = views[i];
      Judged& judged = all[i];
      judged.view = &view;
      judged.fitted = Project(view.columns, left, weights, &judged.coefficients);
      const Eigen::VectorXd after = left - judged.fitted;
      const NoiseFit noise = noise_of({after.data(), static_cast<std::size_t>(after.size())});
      const double ratio = std::max(0.0, LikelihoodRatio(noise, before));
      const double freedom = static_cast<double>(view.degrees_of_freedom);
      const double search_locations = view.SearchLocations(ratio) * static_cast<double>(CountViews(study));
      judged.p_value = std::min(1.0, search_locations * boost::math::cdf(boost::math::complement(
                                                            boost::math::chi_squared(freedom), ratio)));
      judged.score =
          ratio - freedom * std::log(static_cast<double>(before.samples)) - 2.0 * std::log(search_locations);
    });
    const Judged* best = nullptr;
    for (const Judged& judged : all) {
      if (judged.p_value < kReported && (best == nullptr || judged.score > best->score + kMoreThanAnother))
        best = &judged;
    }
    if (best == nullptr) break;
    text += fmt::format("{}{} ({})", text.empty() ? "" : "; ", best->view->describe(best->coefficients),
                        PText(best->p_value));
    left -= best->fitted;
  }
  return text;
}

}  // namespace strainwave::analysis::diagnosis
