// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/residual_views.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "analysis/diagnosis/residual_views.h"
#include "analysis/diagnosis/residuals.h"
#include "analysis/units.h"
#include "bench/diagnosis/picture_frame.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;

constexpr std::size_t kBins = 48;
constexpr std::size_t kFewValues = 12;
constexpr double kLeastSamples = 4.0;

// Sums of one bin.
struct Bin {
  double weight{}, abscissa{}, value{}, square{};
  double samples{};
};

// Places that differ by less count as one: steps that rounding has made uneven.
constexpr double kSameValue = 5e-4;  // of the range

std::vector<Bin> FillBins(std::span<const double> abscissa, std::span<const double> residual,
                          std::span<const double> weights) {
  // A campaign may have cycles without a temperature.
  const ValueRange seen = FiniteRange(abscissa);
  const double range = std::max(seen.high - seen.low, 1e-300);
  const auto share = [&](double here) { return (here - seen.low) / range; };
  std::set<long> values;
  for (std::size_t i = 0; i < abscissa.size() && values.size() <= kFewValues; ++i) {
    if (std::isfinite(abscissa[i])) values.insert(std::lround(share(abscissa[i]) / kSameValue));
  }
  const bool few = values.size() <= kFewValues;
  std::vector<Bin> bins(few ? values.size() : kBins);
  for (std::size_t i = 0; i < abscissa.size(); ++i) {
    if (!(weights[i] > 0.0) || !std::isfinite(abscissa[i])) continue;
    const auto index = few ? static_cast<std::size_t>(std::distance(
                                 values.begin(), values.find(std::lround(share(abscissa[i]) / kSameValue))))
                           : std::min(kBins - 1, static_cast<std::size_t>(share(abscissa[i]) * kBins));
    Bin& bin = bins[index];
    bin.weight += weights[i];
    bin.abscissa += weights[i] * abscissa[i];
    bin.value += weights[i] * residual[i];
    bin.square += weights[i] * residual[i] * residual[i];
    bin.samples += 1.0;
  }
  return bins;
}

}  // namespace

bool IsFolded(const diagnosis::Regressor& regressor) {
  if (!regressor.angle || regressor.values.empty()) return false;
  const auto [low, high] = std::ranges::minmax(regressor.values);
  return high - low > diagnosis::kTurnsOnce;
}

std::vector<double> AbscissaeOf(const diagnosis::Regressor& regressor) {
  std::vector<double> abscissae =
      IsFolded(regressor) ? diagnosis::WithinTurn(regressor.values) : regressor.values;
  for (double& value : abscissae) value *= regressor.per_unit;
  return abscissae;
}

BinnedMeans BinMeans(std::span<const double> abscissa, std::span<const double> residual,
                     std::span<const double> weights) {
  BinnedMeans means;
  for (const Bin& bin : FillBins(abscissa, residual, weights)) {
    if (bin.samples < kLeastSamples) continue;
    const double mean = bin.value / bin.weight;
    const double variance =
        std::max(0.0, bin.square / bin.weight - mean * mean) * bin.samples / (bin.samples - 1.0);
    means.abscissa.push_back(bin.abscissa / bin.weight);
    means.mean.push_back(mean);
    means.two_standard_errors.push_back(2.0 * std::sqrt(variance / bin.samples));
  }
  return means;
}

std::vector<RegressorShare> SharesByRegressor(const DiagnosisReport& report) {
  const diagnosis::Study& study = *report.input.study;
  const std::vector<double> residual = diagnosis::ResidualsOf(study, report.result.nominal);
  const std::vector<double>& weights = report.result.weights;
  std::vector<RegressorShare> shares;
  for (std::size_t k = 0; k < study.regressors().size(); ++k) {
    const diagnosis::Regressor& regressor = study.regressors()[k];
    Bin all;
    double between = 0.0;
    double bins = 0.0;
    for (const Bin& bin : FillBins(AbscissaeOf(regressor), residual, weights)) {
      if (bin.samples < kLeastSamples) continue;
      between += bin.value * bin.value / bin.weight;
      bins += 1.0;
      all.weight += bin.weight;
      all.value += bin.value;
      all.square += bin.square;
      all.samples += bin.samples;
    }
    if (bins < 2.0 || all.samples <= bins) continue;
    const double mean_part = all.value * all.value / all.weight;
    const double total = all.square - mean_part;
    const double raw = total > 0.0 ? (between - mean_part) / total : 0.0;
    // As adjusted R² does it.
    const double share = 1.0 - (1.0 - raw) * (all.samples - 1.0) / (all.samples - bins);
    shares.push_back({k, diagnosis::SplitTitle(regressor).quantity, std::clamp(share, 0.0, 1.0)});
  }
  std::ranges::stable_sort(shares, std::ranges::greater{}, &RegressorShare::share);
  return shares;
}

std::vector<double> AmplitudesAt(std::span<const double> angle_rad, std::span<const double> residual,
                                 std::span<const double> weights, double lowest_order, double step,
                                 std::size_t count) {
  // Sums of cos², sin cos, sin², and of the residual with both, for each order.
  std::vector<double> cc(count), cs(count), ss(count), yc(count), ys(count);
  for (std::size_t i = 0; i < angle_rad.size(); ++i) {
    const double weight = weights[i];
    if (!(weight > 0.0)) continue;
    // The next order's cosine and sine by turning this one's, which keeps 1e-12 over thousands of orders.
    double c = std::cos(lowest_order * angle_rad[i]);
    double s = std::sin(lowest_order * angle_rad[i]);
    const double turn_c = std::cos(step * angle_rad[i]);
    const double turn_s = std::sin(step * angle_rad[i]);
    const double y = weight * residual[i];
    for (std::size_t k = 0; k < count; ++k) {
      cc[k] += weight * c * c;
      cs[k] += weight * c * s;
      ss[k] += weight * s * s;
      yc[k] += y * c;
      ys[k] += y * s;
      const double next = c * turn_c - s * turn_s;
      s = s * turn_c + c * turn_s;
      c = next;
    }
  }
  std::vector<double> amplitude(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double determinant = cc[k] * ss[k] - cs[k] * cs[k];
    const double trace = cc[k] + ss[k];
    // Near half the sampling the samples show only one of the two: the other is taken for nothing.
    if (determinant < 0.02 * trace * trace) {
      amplitude[k] = trace > 0.0 ? std::hypot(yc[k], ys[k]) / trace : 0.0;
      continue;
    }
    const double a = (yc[k] * ss[k] - ys[k] * cs[k]) / determinant;
    const double b = (ys[k] * cc[k] - yc[k] * cs[k]) / determinant;
    amplitude[k] = std::hypot(a, b);
  }
  return amplitude;
}

std::vector<std::size_t> Thinned(std::size_t count, std::size_t most) {
  const std::size_t stride = std::max<std::size_t>(1, (count + most - 1) / most);
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < count; i += stride) indices.push_back(i);
  return indices;
}

}  // namespace strainwave::bench
