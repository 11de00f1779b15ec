// SPDX-License-Identifier: Apache-2.0
#include "analysis/features/packet_features.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/analysis/golden.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::features::packet_features_test {
namespace {

using Values = std::map<std::string, double>;

Values FeaturesOf(const std::vector<double>& x, bool normalised = false) {
  BandWorkspace workspace;
  std::array<double, kBandFeatures> out{};
  BandFeatures(x, normalised, workspace, out);
  Values values;
  for (std::size_t i = 0; i < kBandFeatures; ++i) values[std::string(kBandFeatureNames[i])] = out[i];
  return values;
}

// By the formulas as they are printed, in long double and one after another.
Values ByDefinition(const std::vector<double>& x) {
  using Wide = long double;
  const auto n = static_cast<Wide>(x.size());
  Wide sum = 0, magnitude = 0, squares = 0, root = 0, entropy = 0, logs = 0, peak = 0;
  Wide low = x[0], high = x[0];
  for (const Wide v : x) {
    sum += v;
    magnitude += std::abs(v);
    squares += v * v;
    root += std::sqrt(std::abs(v));
    entropy -= v * v * std::log(v * v);
    logs += std::log(v * v);
    peak = std::max(peak, std::abs(v));
    low = std::min(low, v);
    high = std::max(high, v);
  }
  const Wide mean = sum / n;
  Wide second = 0, third = 0, fourth = 0;
  for (const Wide v : x) {
    second += std::pow(v - mean, 2);
    third += std::pow(v - mean, 3);
    fourth += std::pow(v - mean, 4);
  }
  const Wide std = std::sqrt(second / (n - 1));
  const Wide rms = std::sqrt(squares / n);
  const std::pair<const char*, Wide> all[] = {{"energy", squares},
                                              {"mean", mean},
                                              {"std", std},
                                              {"rms", rms},
                                              {"skewness", third / n / std::pow(std, 3)},
                                              {"kurtosis", fourth / n / std::pow(std, 4)},
                                              {"shape_factor", rms / (magnitude / n)},
                                              {"crest_factor", peak / rms},
                                              {"impulse_factor", peak / (magnitude / n)},
                                              {"margin_factor", peak / std::pow(root / n, 2)},
                                              {"peak", peak},
                                              {"peak_to_peak", high - low},
                                              {"shannon_entropy", entropy},
                                              {"log_energy_entropy", logs}};
  Values values;
  for (const auto& [name, value] : all) values[name] = static_cast<double>(value);
  return values;
}

std::vector<double> Noise(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.4, 1.3);
  std::vector<double> x(n);
  for (double& value : x) value = normal(random);
  return x;
}

TEST(BandFeatures, AreThoseOfTheirDefinitionsAtEveryLength) {
  for (const std::size_t n : {2U, 3U, 7U, 8U, 9U, 15U, 16U, 17U, 310U, 1001U}) {
    const std::vector<double> x = Noise(n, static_cast<unsigned>(n));
    const Values values = FeaturesOf(x);
    for (const auto& [name, wanted] : ByDefinition(x))
      EXPECT_NEAR(values.at(name), wanted, 2e-13 * std::max(1.0, std::abs(wanted)) * 10)
          << name << " of " << n;
  }
}

// Of x = (1, −1, 2, −2): by hand.
TEST(BandFeatures, OfFourNumbersByHand) {
  const Values values = FeaturesOf({1, -1, 2, -2});
  EXPECT_EQ(values.at("energy"), 10.0);
  EXPECT_NEAR(values.at("std"), std::sqrt(10.0 / 3.0), 1e-15);
  EXPECT_NEAR(values.at("kurtosis"), 8.5 / (100.0 / 9.0), 1e-14);
  EXPECT_NEAR(values.at("shape_factor"), std::sqrt(2.5) / 1.5, 1e-15);
  EXPECT_NEAR(values.at("shannon_entropy"), -8.0 * std::log(4.0), 1e-14);
  EXPECT_NEAR(values.at("log_energy_entropy"), 2.0 * std::log(4.0), 1e-14);
  EXPECT_NEAR(FeaturesOf({1, -1, 2, -2}, true).at("shannon_entropy"),
              -0.8 * std::log(0.4) - 0.2 * std::log(0.1), 1e-14);
}

TEST(BandFeatures, OfZerosAndOfAConstantAreNumbers) {
  BandWorkspace workspace;
  std::array<double, kBandFeatures> out{};
  EXPECT_EQ(BandFeatures(std::vector<double>(20, 0.0), false, workspace, out), 20U);
  for (const double value : out) EXPECT_TRUE(std::isfinite(value));
  EXPECT_EQ(out[4], 0.0);
  EXPECT_NEAR(out[13], 20.0 * std::log(std::numeric_limits<double>::min()), 1e-9);
  const Values constant = FeaturesOf(std::vector<double>(33, 0.1));
  EXPECT_EQ(constant.at("std"), 0.0);
  EXPECT_EQ(constant.at("kurtosis"), 0.0);
  EXPECT_NEAR(constant.at("crest_factor"), 1.0, 1e-14);
}

TEST(PacketFeatures, NamesAreOfChannelPathAndFeature) {
  const PacketFeatures features;
  const std::vector<std::string> channels{"current_A", "velocity_rad_per_s"};
  const std::vector<std::string> names = features.Names(channels);
  ASSERT_EQ(names.size(), 224U);
  EXPECT_EQ(names.front(), "current_A.aaa.energy");
  EXPECT_EQ(names[14 + 2], "current_A.aad.std");
  EXPECT_EQ(names.back(), "velocity_rad_per_s.ddd.log_energy_entropy");
}

TEST(PacketFeatures, BandsAreInNaturalOrderWithTheirPlaceByFrequency) {
  const std::vector<PacketBand> bands = PacketBands(3, 1000.0);
  const std::size_t by_frequency[] = {0, 1, 3, 2, 7, 6, 4, 5};
  for (std::size_t natural = 0; natural < 8; ++natural) {
    EXPECT_EQ(bands[natural].by_frequency, by_frequency[natural]);
    EXPECT_EQ(bands[natural].low_hz, 62.5 * static_cast<double>(by_frequency[natural]));
  }
  EXPECT_EQ(bands[2].path, "ada");
}

// A tone in the middle of each band has most of its energy there.
TEST(PacketFeatures, ToneHasItsEnergyInItsBand) {
  PacketFeatures features;
  std::vector<double> out(features.CountPerChannel());
  const std::vector<PacketBand> bands = PacketBands(3, 1000.0);
  for (std::size_t leaf = 0; leaf < bands.size(); ++leaf) {
    const double frequency_hz = 0.5 * (bands[leaf].low_hz + bands[leaf].high_hz);
    std::vector<double> tone(2400);
    for (std::size_t i = 0; i < tone.size(); ++i)
      tone[i] = std::sin(6.283185307179586 * frequency_hz * static_cast<double>(i) / 1000.0);
    features.Compute(tone, out);
    double all = 0.0;
    for (std::size_t other = 0; other < bands.size(); ++other) all += out[other * kBandFeatures];
    EXPECT_GT(out[leaf * kBandFeatures], 0.8 * all) << bands[leaf].path;
  }
}

TEST(PacketFeatures, EqualNumPysOnTheGoldenFile) {
  if (!testing_data::GoldenFolder()) GTEST_SKIP() << testing_data::kNoGolden;
  const auto golden = nlohmann::json::parse(
      std::ifstream(*testing_data::GoldenFolder() / "wpd_features_db6_symmetric_1000.json"));
  const auto names = golden.at("features").get<std::vector<std::string>>();
  PacketFeatures features;
  std::vector<double> out(features.CountPerChannel());
  features.Compute(testing_data::GoldenColumns("signal_1000.csv").at("x"), out);
  std::size_t leaf = 0;
  for (const char* path : {"aaa", "aad", "ada", "add", "daa", "dad", "dda", "ddd"}) {
    const auto values = golden.at("bands").at(path).get<std::vector<double>>();
    // Those that are defined alike there: moments there are of the population.
    constexpr std::pair<const char*, std::size_t> kAlike[] = {
        {"mean", 1},  {"rms", 3},     {"peak", 10},     {"peak_to_peak", 11}, {"crest", 7},
        {"shape", 6}, {"impulse", 8}, {"clearance", 9}, {"energy", 0}};
    for (const auto& [theirs, ours] : kAlike) {
      const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), theirs) - names.begin());
      EXPECT_NEAR(out[leaf * kBandFeatures + ours], values.at(at), 1e-9 * std::max(1.0, values[at]))
          << path << " " << theirs;
    }
    ++leaf;
  }
}

TEST(PacketFeatures, RefusesWhatIsNoSignal) {
  PacketFeatures features;
  std::vector<double> out(features.CountPerChannel());
  EXPECT_EQ(MessageOf([&] {
              features.Compute(std::vector<double>{1.0, std::nan("")}, out);
            }),
            "signal[1] = nan is not finite");
  EXPECT_EQ(MessageOf([] { PacketFeatures({.levels = 11}); }), "levels = 11 is not in 1 to 10");
}

}  // namespace
}  // namespace strainwave::analysis::features::packet_features_test
