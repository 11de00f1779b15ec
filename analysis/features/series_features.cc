// SPDX-License-Identifier: Apache-2.0
#include "analysis/features/series_features.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/arguments.h"
#include "analysis/features/autoregression.h"
#include "analysis/features/langevin.h"
#include "analysis/features/sums.h"

namespace strainwave::analysis::features {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kEntropyBins = 10;

// Bins hold their lower edge, the last one both.
double BinnedEntropy(SortedSeries& sorted) {
  const double low = sorted.At(0);
  const double high = sorted.At(sorted.size() - 1);
  if (low == high) return -0.0;
  const double width = (high - low) / static_cast<double>(kEntropyBins);
  const auto n = static_cast<double>(sorted.size());
  double entropy = 0.0;
  std::size_t begin = 0;
  for (std::size_t bin = 1; bin <= kEntropyBins; ++bin) {
    const double edge = static_cast<double>(bin) * width + low;
    const std::size_t end = bin == kEntropyBins ? sorted.size() : std::max(begin, sorted.CountBelow(edge));
    const double share = static_cast<double>(end - begin) / n;
    if (share > 0.0) entropy -= share * std::log(share);
    begin = end;
  }
  return entropy;
}

double AutocorrelationAtLagOne(std::span<const double> centred, double variance) {
  // A variance that numpy.isclose takes for zero, whatever the unit.
  constexpr double kVanishing = 1e-8;
  if (centred.size() < 2 || variance <= kVanishing) return kUndefined;
  std::array<double, 2> products{};
  LagProducts(centred, products);
  return products[1] / (static_cast<double>(centred.size() - 1) * variance);
}

std::array<double, kAutoregressiveOrder + 1> Autoregressive(std::span<const double> x,
                                                            std::span<const double> centred, double mean) {
  if (x.size() >= 2 * kAutoregressiveOrder + 1) return AutoregressiveCoefficients(x, centred, mean);
  std::array<double, kAutoregressiveOrder + 1> nothing{};
  std::fill_n(nothing.begin(), kAutoregressiveOrder, kUndefined);
  return nothing;
}

}  // namespace

const std::array<std::string_view, kSeriesFeatures> kSeriesFeatureNames{
    "mean",
    "median",
    "standard_deviation",
    "variance",
    "quantile__q_0.05",
    "quantile__q_0.25",
    "quantile__q_0.75",
    "quantile__q_0.95",
    "root_mean_square",
    "mean_change",
    "number_crossing_m__m_0",
    "mean_crossing",
    "binned_entropy__max_bins_10",
    "ar_coefficient__coeff_0__k_10",
    "ar_coefficient__coeff_1__k_10",
    "ar_coefficient__coeff_2__k_10",
    "ar_coefficient__coeff_3__k_10",
    "ar_coefficient__coeff_4__k_10",
    "ar_coefficient__coeff_5__k_10",
    "ar_coefficient__coeff_6__k_10",
    "ar_coefficient__coeff_7__k_10",
    "ar_coefficient__coeff_8__k_10",
    "ar_coefficient__coeff_9__k_10",
    "ar_coefficient__coeff_10__k_10",
    "abs_energy",
    "autocorrelation__lag_1",
    "c3__lag_1",
    "c3__lag_2",
    "c3__lag_3",
    "cid_ce__normalize_True",
    "first_location_of_maximum",
    "max_langevin_fixed_point__m_3__r_30",
    "time_reversal_asymmetry_statistic__lag_1",
    "time_reversal_asymmetry_statistic__lag_2",
    "time_reversal_asymmetry_statistic__lag_3",
};

void SeriesFeatures(std::span<const double> x, SeriesWorkspace& workspace,
                    std::span<double, kSeriesFeatures> out) {
  RequireAtLeast("x", x, 1);
  RequireFinite("x", x);
  const auto n = static_cast<double>(x.size());
  const double mean = PairwiseSum(x) / n;
  workspace.centred.resize(x.size());
  const std::span<const double> centred = workspace.centred;
  const double variance = Shift(x, mean, workspace.centred) / n;
  const double deviation = std::sqrt(variance);
  SortedSeries& sorted = workspace.sorted;
  sorted.Assign(x);
  const auto quantile = [&](double q) {
    return Quantile(x.size(), q, [&](std::size_t k) { return sorted.At(k); });
  };
  const NeighbourProducts products = NeighbourProductsOf(x);
  auto place = out.begin();
  const auto put = [&place](auto... values) { ((*place++ = values), ...); };
  put(mean, 0.5 * (sorted.At((x.size() - 1) / 2) + sorted.At(x.size() / 2)), deviation, variance);
  put(quantile(0.05), quantile(0.25), quantile(0.75), quantile(0.95));
  put(std::sqrt(products.squares / n), x.size() > 1 ? (x.back() - x.front()) / (n - 1.0) : kUndefined);
  put(static_cast<double>(CrossingCount(x, 0.0)), static_cast<double>(CrossingCount(x, mean)));
  put(BinnedEntropy(sorted));
  for (const double coefficient : Autoregressive(x, centred, mean)) put(coefficient);
  put(products.squares, AutocorrelationAtLagOne(centred, variance));
  put(products.third[0], products.third[1], products.third[2]);
  put(deviation == 0.0 ? 0.0 : std::sqrt(products.squared_steps) / deviation);
  put(static_cast<double>(std::ranges::find(x, sorted.At(x.size() - 1)) - x.begin()) / n);
  put(LargestLangevinFixedPoint(x, sorted));
  put(products.asymmetry[0], products.asymmetry[1], products.asymmetry[2]);
}

}  // namespace strainwave::analysis::features
