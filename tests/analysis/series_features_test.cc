// SPDX-License-Identifier: Apache-2.0
#include "analysis/features/series_features.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "analysis/features/wavelet_features.h"
#include "tests/analysis/golden.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::features::series_features_test {
namespace {

using Features = std::map<std::string, double, std::less<>>;
const double kNaN = std::numeric_limits<double>::quiet_NaN();

Features FeaturesOf(const std::vector<double>& x) {
  SeriesWorkspace workspace;
  std::array<double, kSeriesFeatures> values{};
  SeriesFeatures(x, workspace, values);
  Features features;
  for (std::size_t i = 0; i < kSeriesFeatures; ++i) features[std::string(kSeriesFeatureNames[i])] = values[i];
  return features;
}

std::vector<double> Noise(std::size_t n, unsigned seed, double mean = 0.3) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(mean, 1.0);
  std::vector<double> x(n);
  double slow = 0.0;
  for (double& value : x) value = slow = 0.7 * slow + normal(random);
  return x;
}

// Each feature by a plain loop over its definition, in long double.
Features ByDefinition(const std::vector<double>& x) {
  using Wide = long double;
  const std::size_t n = x.size();
  const auto mean_over = [](std::size_t count, auto term) {
    Wide sum = 0.0L;
    for (std::size_t t = 0; t < count; ++t) sum += term(t);
    return sum / static_cast<Wide>(count);
  };
  const auto at = [&](std::size_t t) { return static_cast<Wide>(x[t]); };
  const Wide mean = mean_over(n, at);
  const Wide variance = mean_over(n, [&](std::size_t t) { return (at(t) - mean) * (at(t) - mean); });
  const Wide squares = mean_over(n, [&](std::size_t t) { return at(t) * at(t); });
  std::vector<double> sorted = x;
  std::sort(sorted.begin(), sorted.end());
  const auto quantile = [&](double q) {
    const double place = q * static_cast<double>(n - 1);
    const auto below = static_cast<std::size_t>(place);
    const double above = below + 1 < n ? sorted[below + 1] : sorted[below];
    return static_cast<Wide>(sorted[below]) +
           (place - std::floor(place)) * (static_cast<Wide>(above) - sorted[below]);
  };
  const auto crossings = [&](Wide level) {
    Wide count = 0.0L;
    for (std::size_t t = 1; t < n; ++t) count += (at(t) > level) != (at(t - 1) > level) ? 1.0L : 0.0L;
    return count;
  };
  Wide entropy = 0.0L;
  for (int bin = 0; bin < 10; ++bin) {
    const Wide low = sorted.front();
    const Wide width = (static_cast<Wide>(sorted.back()) - low) / 10.0L;
    Wide count = 0.0L;
    for (const double value : x) {
      const int own = std::min(9, static_cast<int>((value - low) / width));
      count += own == bin ? 1.0L : 0.0L;
    }
    if (count > 0.0L) entropy -= count / static_cast<Wide>(n) * std::log(count / static_cast<Wide>(n));
  }
  const Wide steps =
      mean_over(n - 1, [&](std::size_t t) { return (at(t + 1) - at(t)) * (at(t + 1) - at(t)); });
  std::map<std::string, Wide> wide{
      {"mean", mean},
      {"median", quantile(0.5)},
      {"standard_deviation", std::sqrt(variance)},
      {"variance", variance},
      {"quantile__q_0.05", quantile(0.05)},
      {"quantile__q_0.25", quantile(0.25)},
      {"quantile__q_0.75", quantile(0.75)},
      {"quantile__q_0.95", quantile(0.95)},
      {"root_mean_square", std::sqrt(squares)},
      {"mean_change", (at(n - 1) - at(0)) / static_cast<Wide>(n - 1)},
      {"number_crossing_m__m_0", crossings(0.0L)},
      {"mean_crossing", crossings(mean)},
      {"binned_entropy__max_bins_10", entropy},
      {"abs_energy", squares * static_cast<Wide>(n)},
      {"autocorrelation__lag_1",
       mean_over(n - 1, [&](std::size_t t) { return (at(t) - mean) * (at(t + 1) - mean); }) / variance},
      {"cid_ce__normalize_True", std::sqrt(steps * static_cast<Wide>(n - 1) / variance)},
      {"first_location_of_maximum",
       static_cast<Wide>(std::max_element(x.begin(), x.end()) - x.begin()) / static_cast<Wide>(n)}};
  for (std::size_t lag = 1; lag <= 3; ++lag) {
    const std::string number = std::to_string(lag);
    wide["c3__lag_" + number] =
        mean_over(n - 2 * lag, [&](std::size_t t) { return at(t) * at(t + lag) * at(t + 2 * lag); });
    wide["time_reversal_asymmetry_statistic__lag_" + number] = mean_over(n - 2 * lag, [&](std::size_t t) {
      return at(t + 2 * lag) * at(t + 2 * lag) * at(t + lag) - at(t + lag) * at(t) * at(t);
    });
  }
  Features features;
  for (const auto& [name, value] : wide) features[name] = static_cast<double>(value);
  return features;
}

void ExpectClose(double got, double expected, double tolerance, const std::string& what) {
  if (std::isnan(expected)) {
    EXPECT_TRUE(std::isnan(got)) << what << " is " << got << " (expected NaN)";
    return;
  }
  EXPECT_NEAR(got, expected, tolerance * std::max(std::abs(expected), 1e-9)) << what;
}

TEST(SeriesFeatures, AreTheirDefinitions) {
  for (const std::size_t n : {30U, 257U, 1000U, 5003U}) {
    const std::vector<double> x = Noise(n, static_cast<unsigned>(n));
    const Features got = FeaturesOf(x);
    for (const auto& [name, expected] : ByDefinition(x)) {
      ExpectClose(got.at(name), expected, 1e-11, name + " of " + std::to_string(n));
    }
  }
}

// Ten undamped tones and a constant obey a recursion of order ten (from the products of 1 − 2 cos ω B + B²).
TEST(SeriesFeatures, RecoverTheRecursionThatASeriesObeys) {
  std::vector<double> polynomial{1.0};
  const double damping = 0.999;
  for (const double omega : {0.3, 0.8, 1.3, 1.9, 2.6}) {
    const double factor[] = {1.0, -2.0 * damping * std::cos(omega), damping * damping};
    std::vector<double> product(polynomial.size() + 2, 0.0);
    for (std::size_t i = 0; i < polynomial.size(); ++i) {
      for (std::size_t j = 0; j < 3; ++j) product[i + j] += polynomial[i] * factor[j];
    }
    polynomial = product;
  }
  std::vector<double> x = Noise(10, 4);
  while (x.size() < 400) {
    double next = 0.25;
    for (std::size_t k = 1; k <= 10; ++k) next -= polynomial[k] * x[x.size() - k];
    x.push_back(next);
  }
  const Features got = FeaturesOf(x);
  EXPECT_NEAR(got.at("ar_coefficient__coeff_0__k_10"), 0.25, 1e-9);
  for (std::size_t k = 1; k <= 10; ++k) {
    EXPECT_NEAR(got.at("ar_coefficient__coeff_" + std::to_string(k) + "__k_10"), -polynomial[k], 1e-9) << k;
  }
}

TEST(SeriesFeatures, AutoregressionMinimizesTheErrorOfARandomSeries) {
  const std::vector<double> x = Noise(700, 11, 2.0);
  Eigen::MatrixXd rows(690, 11);
  Eigen::VectorXd next(690);
  for (Eigen::Index t = 0; t < 690; ++t) {
    rows(t, 0) = 1.0;
    for (Eigen::Index k = 1; k <= 10; ++k) rows(t, k) = x[static_cast<std::size_t>(t + 10 - k)];
    next(t) = x[static_cast<std::size_t>(t + 10)];
  }
  const Eigen::VectorXd expected = rows.colPivHouseholderQr().solve(next);
  const Features got = FeaturesOf(x);
  for (Eigen::Index k = 0; k <= 10; ++k) {
    ExpectClose(got.at("ar_coefficient__coeff_" + std::to_string(k) + "__k_10"), expected(k), 1e-10,
                std::to_string(k));
  }
}

// Bins by sorting, the cubic by QR, its largest root by halving from above.
TEST(SeriesFeatures, FindTheFixedPointOfACubicDrift) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> x{0.4};
  while (x.size() < 3993)
    x.push_back(x.back() + 0.2 * (x.back() - std::pow(x.back(), 3)) + 0.3 * normal(random));
  std::vector<std::pair<double, double>> steps;
  for (std::size_t t = 0; t + 1 < x.size(); ++t) steps.emplace_back(x[t], x[t + 1] - x[t]);
  std::sort(steps.begin(), steps.end());
  Eigen::MatrixXd powers(30, 4);
  Eigen::VectorXd mean_step(30);
  std::size_t begin = 0;
  for (int bin = 0; bin < 30; ++bin) {
    // 3992 values, none of them on an inner edge, which are at places 3991 (bin + 1) / 30.
    const std::size_t end =
        bin == 29 ? steps.size() : static_cast<std::size_t>(3991.0 * (bin + 1) / 30.0) + 1;
    double value = 0.0;
    double step = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      value += steps[i].first / static_cast<double>(end - begin);
      step += steps[i].second / static_cast<double>(end - begin);
    }
    powers.row(bin) << 1.0, value, value * value, value * value * value;
    mean_step(bin) = step;
    begin = end;
  }
  const Eigen::Vector4d cubic = powers.householderQr().solve(mean_step);
  double low = 0.5;
  double high = 3.0;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (low + high);
    const double drift = cubic(0) + middle * (cubic(1) + middle * (cubic(2) + middle * cubic(3)));
    (drift > 0.0 ? low : high) = middle;
  }
  EXPECT_NEAR(low, 1.0, 0.1);
  EXPECT_NEAR(FeaturesOf(x).at("max_langevin_fixed_point__m_3__r_30"), low, 1e-10);
}

TEST(SeriesFeatures, OfAConstantHaveWhatDefinitionsLeave) {
  for (const double level : {0.0, 2.5, -1e-7}) {
    const Features got = FeaturesOf(std::vector<double>(64, level));
    EXPECT_EQ(got.at("median"), level);
    EXPECT_EQ(got.at("variance"), 0.0);
    EXPECT_EQ(got.at("binned_entropy__max_bins_10"), 0.0);
    EXPECT_EQ(got.at("cid_ce__normalize_True"), 0.0);
    EXPECT_EQ(got.at("first_location_of_maximum"), 0.0);
    EXPECT_TRUE(std::isnan(got.at("autocorrelation__lag_1")));
    EXPECT_TRUE(std::isnan(got.at("max_langevin_fixed_point__m_3__r_30")));
    // The least norm among all coefficients that give the level again.
    const double norm = 1.0 + 10.0 * level * level;
    EXPECT_NEAR(got.at("ar_coefficient__coeff_0__k_10"), level / norm, 1e-14);
    EXPECT_NEAR(got.at("ar_coefficient__coeff_7__k_10"), level * level / norm, 1e-14);
  }
}

TEST(SeriesFeatures, OfShortSeriesAreMissingWhereTheyHaveNoMeaning) {
  for (std::size_t n = 1; n <= 24; ++n) {
    const Features got = FeaturesOf(Noise(n, 9));
    EXPECT_EQ(std::isnan(got.at("mean_change")), n < 2) << n;
    EXPECT_EQ(std::isnan(got.at("ar_coefficient__coeff_0__k_10")), n < 21) << n;
    EXPECT_EQ(got.at("ar_coefficient__coeff_10__k_10") == 0.0, n < 21) << n;
    for (std::size_t lag = 1; lag <= 3; ++lag) {
      const std::string number = std::to_string(lag);
      EXPECT_EQ(got.at("c3__lag_" + number) == 0.0, n <= 2 * lag) << n;
      EXPECT_EQ(got.at("time_reversal_asymmetry_statistic__lag_" + number) == 0.0, n <= 2 * lag) << n;
    }
  }
  EXPECT_EQ(FeaturesOf({3.0, 1.0}).at("median"), 2.0);
  EXPECT_EQ(FeaturesOf({-4.0}).at("root_mean_square"), 4.0);
}

TEST(SeriesFeatures, TakeAVarianceBelowTheToleranceOfTheReferenceForNone) {
  std::vector<double> x = Noise(200, 2);
  for (double& value : x) value *= 1e-5;
  EXPECT_TRUE(std::isnan(FeaturesOf(x).at("autocorrelation__lag_1")));
  for (double& value : x) value *= 1e3;
  EXPECT_FALSE(std::isnan(FeaturesOf(x).at("autocorrelation__lag_1")));
}

TEST(SortedSeries, SortsWhateverItsSpread) {
  std::vector<double> spread = Noise(5000, 8);
  spread[17] = 1e300;
  spread[18] = -1e300;
  std::vector<double> few(4000);
  for (std::size_t i = 0; i < few.size(); ++i) few[i] = static_cast<double>(i * 7 % 3);
  std::vector<double> tiny(3000);
  for (std::size_t i = 0; i < tiny.size(); ++i) tiny[i] = static_cast<double>(i * 11 % 3000) * 5e-324;
  std::vector<double> wide = Noise(3000, 1);
  wide[5] = 1.7e308;
  wide[6] = -1.7e308;
  SortedSeries sorted;
  for (std::vector<double> x : {Noise(10, 1), Noise(100000, 2), spread, few, tiny, wide}) {
    sorted.Assign(x);
    // From the middle on, as buckets are sorted when they are asked for.
    std::vector<double> values(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      const std::size_t k = (i + x.size() / 2) % x.size();
      values[k] = sorted.At(k);
    }
    sorted.Assign(x);
    for (std::size_t i = 0; i < x.size(); i += x.size() / 10) {
      EXPECT_EQ(sorted.CountBelow(x[i]), std::ranges::count_if(x, [&](double v) { return v < x[i]; }));
      const double above = std::nextafter(x[i], INFINITY);
      EXPECT_EQ(sorted.CountBelow(above), std::ranges::count_if(x, [&](double v) { return v < above; }));
    }
    std::sort(x.begin(), x.end());
    EXPECT_EQ(values, x);
  }
}

std::map<std::string, std::vector<double>> GoldenSeries() {
  std::map<std::string, std::vector<double>> series;
  const auto edges = nlohmann::json::parse(std::ifstream(*testing_data::GoldenFolder() / "edge_series.json"));
  for (const auto& [name, values] : edges.items()) series[name] = values.get<std::vector<double>>();
  for (const std::string n : {"1000", "1023", "4096"}) {
    series["signal_" + n] = testing_data::GoldenColumns("signal_" + n + ".csv").at("x");
    for (const std::string wavelet : {"sym8", "sym4", "db6"}) {
      for (const std::string mode : {"symmetric", "periodization"}) {
        const std::string name = wavelet + "_" + mode + "_" + n;
        const auto columns = testing_data::GoldenColumns("dwt_" + name + ".csv");
        for (const std::string level : {"1", "2", "3", "4", "5"})
          series[name + "_cA" + level] = columns.at("cA" + level);
      }
    }
  }
  return series;
}

TEST(SeriesFeatures, EqualThoseOfTsfreshOnTheGoldenSeries) {
  if (!testing_data::GoldenFolder()) GTEST_SKIP() << testing_data::kNoGolden;
  const auto series = GoldenSeries();
  std::ifstream table(*testing_data::GoldenFolder() / "tsfresh_features.csv");
  std::string line;
  std::string cell;
  std::getline(table, line);
  std::vector<std::string> header;
  for (std::istringstream names(line); std::getline(names, cell, ',');) header.push_back(cell);
  ASSERT_TRUE(
      std::equal(header.begin() + 2, header.end(), kSeriesFeatureNames.begin(), kSeriesFeatureNames.end()));
  std::size_t rows = 0;
  while (std::getline(table, line)) {
    std::istringstream cells(line);
    std::string name;
    std::getline(cells, name, ',');
    std::getline(cells, cell, ',');
    const Features got = FeaturesOf(series.at(name));
    // What the maker of the table calls the choice of an implementation.
    const bool degenerate = name.ends_with("_64");
    for (std::size_t i = 2; i < header.size(); ++i) {
      std::getline(cells, cell, ',');
      const bool ill = header[i].starts_with("ar_") || header[i].starts_with("max_langevin");
      if (degenerate && ill) continue;
      ExpectClose(got.at(header[i]), cell == "nan" ? kNaN : std::stod(cell), 1e-9, name + " " + header[i]);
    }
    ++rows;
  }
  EXPECT_EQ(rows, series.size());
}

TEST(WaveletFeatures, AreThoseOfEachApproximationUnderItsName) {
  WaveletFeatures features({.wavelet = "db3", .border = wavelets::Border::kPeriodization, .levels = 2});
  const std::vector<double> x = Noise(600, 6);
  std::vector<double> values(features.CountPerChannel());
  features.Compute(x, values);
  const std::vector<std::string> channels{"accel_x_m_per_s2", "current_A"};
  const std::vector<std::string> names = features.Names(channels);
  ASSERT_EQ(names.size(), 140U);
  EXPECT_EQ(names.front(), "accel_x_m_per_s2.a1.mean");
  EXPECT_EQ(names[35 + 8], "accel_x_m_per_s2.a2.root_mean_square");
  EXPECT_EQ(names[70 + 34], "current_A.a1.time_reversal_asymmetry_statistic__lag_3");
  wavelets::Decomposition decomposition;
  wavelets::Decompose(x, wavelets::FilterBankOf("db3"), wavelets::Border::kPeriodization, 2,
                      wavelets::Details::kLeaveOut, decomposition);
  EXPECT_EQ(values[35 + 8], FeaturesOf(decomposition.approximations[1]).at("root_mean_square"));
}

TEST(SeriesFeatures, SayWhatIsWrongWithTheirArguments) {
  SeriesWorkspace workspace;
  std::array<double, kSeriesFeatures> out{};
  EXPECT_EQ(MessageOf([&] { SeriesFeatures({}, workspace, out); }), "x has 0 values (expected at least 1)");
  const std::vector<double> with_nan{1.0, kNaN};
  EXPECT_EQ(MessageOf([&] { SeriesFeatures(with_nan, workspace, out); }), "x[1] = nan is not finite");
  EXPECT_EQ(MessageOf([] { WaveletFeatures features({.levels = 31}); }), "levels = 31 is not in 1 to 30");
  WaveletFeatures features;
  EXPECT_EQ(MessageOf([&] { features.Compute(with_nan, out); }), "out has 35 places (expected 245)");
}

// Squares and cubes that overflow: features without a value, and nothing read that was never computed.
TEST(SeriesFeatures, OfValuesWhoseSquaresOverflowAreNoNumbers) {
  for (const double huge : {1e155, 1e200, -1.7e308}) {
    std::vector<double> x = Noise(500, 7);
    x[10] = huge;
    const Features features = FeaturesOf(x);
    EXPECT_FALSE(std::isfinite(features.at("variance"))) << huge;
    EXPECT_TRUE(std::isnan(features.at("ar_coefficient__coeff_3__k_10"))) << huge;
  }
}

}  // namespace
}  // namespace strainwave::analysis::features::series_features_test
