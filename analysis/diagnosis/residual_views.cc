// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/residual_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <iterator>
#include <numeric>
#include <optional>

#include "analysis/diagnosis/phasors.h"
#include "analysis/diagnosis/scans.h"
#include "analysis/noise_level.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

// What the residual has that its own past does not predict; the first samples of each segment get no weight.
struct Innovations {
  std::vector<double> values;
  std::vector<double> weights;
};

Innovations InnovationsOf(const Study& study, std::span<const double> residual,
                          std::span<const double> weights, const NoiseFit& noise) {
  const std::size_t n = residual.size();
  const auto order = static_cast<std::size_t>(noise.order);
  Innovations out{std::vector<double>(n, 0.0), std::vector<double>(n, 0.0)};
  const std::span<const std::size_t> segments = study.segments();
  std::size_t run = 0;
  std::size_t segment = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (segment < segments.size() && segments[segment] == i) {
      run = 0;
      ++segment;
    }
    if (weights[i] > 0.0 && run >= order) {
      out.values[i] = residual[i];
      out.weights[i] = weights[i];
      for (std::size_t k = 1; k <= order; ++k) {
        out.values[i] -= noise.series.front().coefficients[k - 1] * residual[i - k];
      }
    }
    run = weights[i] > 0.0 ? run + 1 : 0;
  }
  return out;
}

std::string PeriodText(double period_s) {
  if (period_s < 1.0) return fmt::format("{:.4g} Hz", 1.0 / period_s);
  if (period_s < 120.0) return fmt::format("a period of {:.4g} s", period_s);
  if (period_s < 7200.0) return fmt::format("a period of {:.4g} min", period_s / 60.0);
  return fmt::format("a period of {:.4g} h", period_s / 3600.0);
}

std::string AliasText(double order, double folding, double step_deg) {
  if (!(folding > 0.0) || folding > 2.0 * kHighestOrderPerTurn) return {};
  return fmt::format(" ({:.4g} deg steps: also {:.6g}, {:.6g})", step_deg, folding - order, folding + order);
}

bool IsTime(const Regressor& regressor) { return regressor.name == "time"; }

std::string LineText(const Regressor& regressor, double order, double folding, double amplitude,
                     const std::string& unit) {
  if (regressor.angle) {
    return fmt::format("line at {:.2f} per {}, {:.3g} {}{}", order, TurnOf(regressor), amplitude, unit,
                       AliasText(order, folding, DegFromRad(kTwoPi / folding)));
  }
  return fmt::format("line over time with {}, {:.3g} {}", PeriodText(kTwoPi / order), amplitude, unit);
}

void AddLines(const Study& study, const Regressor& regressor, std::span<const double> residual,
              std::span<const double> weights, const NoiseFit& noise, std::vector<ResidualView>& views) {
  const double span = SpanOf(regressor.values);
  if (!(span > 0.0) || (regressor.angle && span < 0.5 * kTwoPi)) return;
  const double folding = FoldingOrder(regressor.values, weights);
  const double lowest = kTwoPi / span;
  double highest = 0.5 * lowest * static_cast<double>(noise.samples);
  if (folding > 0.0) highest = std::min(highest, 0.5 * folding * (1.0 + 1e-9));
  if (regressor.angle) highest = std::min(highest, kHighestOrderPerTurn);
  if (!(highest > lowest)) return;

  const double even_step = folding > 0.0 ? kTwoPi / folding : 0.0;
  std::vector<LinePeak> peaks = FindLines(regressor.values, residual, weights, lowest, highest, 2, even_step);
  if (noise.order > 0) {
    const Innovations white = InnovationsOf(study, residual, weights, noise);
    for (const LinePeak& peak :
         FindLines(regressor.values, white.values, white.weights, lowest, highest, 1, even_step)) {
      peaks.push_back(peak);
    }
  }
  const std::string unit = study.unit();
  const double unit_per_si = study.unit_per_si();
  for (const LinePeak& peak : peaks) {
    ResidualView view;
    view.columns.resize(static_cast<Index>(residual.size()), 2);
    ForEachPhasor(regressor.values, peak.order, [&](std::size_t i, std::complex<double> phasor) {
      view.columns(static_cast<Index>(i), 0) = phasor.real();
      view.columns(static_cast<Index>(i), 1) = phasor.imag();
    });
    view.degrees_of_freedom = 2;
    view.search_locations = IndependentOrders(regressor.values, lowest, highest);
    view.continuous = true;
    // What an order is known to: that much beside a whole number, it is the whole number.
    const double order_sd_times_amplitude =
        noise.innovation_sd * std::sqrt(24.0 / static_cast<double>(noise.samples)) / span;
    view.describe = [&regressor, found = peak.order, order_sd_times_amplitude, folding, unit,
                     unit_per_si](const Eigen::VectorXd& coefficients) {
      const double amplitude = coefficients.norm();
      const double whole = std::round(found);
      const bool is_whole =
          whole > 0.0 && std::abs(found - whole) < 2.5 * order_sd_times_amplitude / amplitude;
      return LineText(regressor, regressor.angle && is_whole ? whole : found, folding,
                      amplitude * unit_per_si, unit);
    };
    views.push_back(std::move(view));
  }
}

// Over angles the angle within a turn, so that what comes back each turn adds up.
void AddWindows(const Study& study, const Regressor& regressor, std::span<const double> residual,
                std::span<const double> weights, std::size_t samples, std::vector<ResidualView>& views) {
  std::vector<double> abscissa = regressor.values;
  if (regressor.angle && SpanOf(abscissa) > kTurnsOnce) {
    for (double& value : abscissa) {
      value -= kTwoPi * std::floor(value / kTwoPi);
    }
  }
  const double span = SpanOf(abscissa);
  if (!(span > 0.0)) return;
  const double narrowest = span * std::max(6.0 / static_cast<double>(samples), 1.0 / 400.0);
  if (!WindowsMove(abscissa, narrowest)) return;
  const double widest = 0.25 * span;
  double search_locations = 0.0;
  for (double width = narrowest; width <= widest * 1.0001; width *= std::sqrt(2.0)) {
    search_locations += 4.0 * (span / width + 1.0);  // as FindWindows steps
  }
  for (const WindowPeak& peak : FindWindows(abscissa, residual, weights, narrowest, widest, 2)) {
    ResidualView view;
    view.columns.resize(static_cast<Index>(residual.size()), 1);
    for (std::size_t i = 0; i < residual.size(); ++i) {
      const bool inside = std::abs(abscissa[i] - peak.centre) <= 0.5 * peak.width;
      view.columns(static_cast<Index>(i), 0) = inside ? 1.0 : 0.0;
    }
    view.degrees_of_freedom = 1;
    view.search_locations = search_locations;
    view.describe = [&regressor, peak, unit = study.unit(),
                     unit_per_si = study.unit_per_si()](const Eigen::VectorXd& coefficients) {
      const TitleParts title = SplitTitle(regressor);
      return fmt::format("window from {:.4g} to {:.4g} {} of {}, {:+.3g} {}",
                         (peak.centre - 0.5 * peak.width) * regressor.per_unit,
                         (peak.centre + 0.5 * peak.width) * regressor.per_unit, title.unit, title.quantity,
                         coefficients(0) * unit_per_si, unit);
    };
    views.push_back(std::move(view));
  }
}

}  // namespace

double ResidualView::SearchLocations(double likelihood_ratio) const {
  return search_locations * (continuous ? std::sqrt(std::max(1.0, 0.5 * likelihood_ratio)) : 1.0);
}

double FoldingOrder(std::span<const double> angle_rad, std::span<const double> weights) {
  constexpr double kEvenWithin = 0.02;  // of a step
  std::vector<double> used;
  for (std::size_t i = 0; i < angle_rad.size(); ++i) {
    if (weights[i] > 0.0) used.push_back(angle_rad[i]);
  }
  if (used.size() < 8) return 0.0;
  const double span = SpanOf(used);
  std::vector<double> steps;
  for (std::size_t i = 1; i < used.size(); ++i) {
    const double step = std::abs(used[i] - used[i - 1]);
    // Two passes of one position are no step.
    if (step > 1e-6 * span) steps.push_back(step);
  }
  double step = Median(std::move(steps));
  if (!(step > 0.0)) return 0.0;
  step = span / std::round(span / step);
  const double first = *std::min_element(used.begin(), used.end());
  for (const double value : used) {
    const double steps_from_first = (value - first) / step;
    if (std::abs(steps_from_first - std::round(steps_from_first)) > kEvenWithin) return 0.0;
  }
  return kTwoPi / step;
}

std::vector<double> WithinTurn(std::span<const double> angle_rad) {
  std::vector<double> within(angle_rad.begin(), angle_rad.end());
  for (double& angle : within) angle -= kTwoPi * std::floor(angle / kTwoPi + 1e-9);
  return within;
}

TitleParts SplitTitle(const Regressor& regressor) {
  const std::size_t slash = regressor.title.find(" / ");
  if (slash == std::string::npos) return {regressor.title.empty() ? regressor.name : regressor.title, ""};
  return {regressor.title.substr(0, slash), regressor.title.substr(slash + 3)};
}

std::string TurnOf(const Regressor& regressor) {
  constexpr std::string_view kSuffix = "_angle";
  if (regressor.name.ends_with(kSuffix)) {
    return regressor.name.substr(0, regressor.name.size() - kSuffix.size()) + " turn";
  }
  return "turn of " + regressor.name;
}

std::size_t CountViews(const Study& study) {
  std::size_t count = 0;
  for (const Regressor& regressor : study.regressors()) {
    // Lines and windows, or a dependence; over time all three.
    count += regressor.angle ? 2 : IsTime(regressor) ? 3 : 1;
  }
  return std::max<std::size_t>(count, 1);
}

std::vector<ResidualView> ResidualViewsOf(const Study& study, std::span<const double> residual,
                                          std::span<const double> weights, const NoiseFit& noise,
                                          const ParallelFor& parallel) {
  using Searches = std::vector<std::function<void(std::vector<ResidualView>&)>>;
  Searches searches;
  const auto search_lines = [&](const Regressor& regressor) {
    searches.emplace_back([&](auto& views) { AddLines(study, regressor, residual, weights, noise, views); });
  };
  const auto search_windows = [&](const Regressor& regressor) {
    searches.emplace_back(
        [&](auto& views) { AddWindows(study, regressor, residual, weights, noise.samples, views); });
  };
  for (const Regressor& regressor : study.regressors()) {
    if (regressor.angle) search_lines(regressor);
  }
  for (const Regressor& regressor : study.regressors()) {
    if (regressor.angle) search_windows(regressor);
  }
  for (const Regressor& regressor : study.regressors()) {
    if (!regressor.angle)
      searches.emplace_back([&](auto& views) { AddDependence(study, regressor, weights, views); });
  }
  for (const Regressor& regressor : study.regressors()) {
    if (!IsTime(regressor)) continue;
    search_lines(regressor);
    search_windows(regressor);
  }
  std::vector<std::vector<ResidualView>> found(searches.size());
  parallel(searches.size(), [&](std::size_t i) { searches[i](found[i]); });
  std::vector<ResidualView> views;
  for (std::vector<ResidualView>& own : found) std::ranges::move(own, std::back_inserter(views));
  return views;
}

}  // namespace strainwave::analysis::diagnosis
