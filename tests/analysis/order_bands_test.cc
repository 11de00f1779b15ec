// SPDX-License-Identifier: Apache-2.0
#include "analysis/features/order_bands.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "tests/analysis/message_of.h"

namespace strainwave::analysis::features::order_bands_test {
namespace {

constexpr double kSamplesPerTurn = 517.3;

std::vector<double> Tone(double order, double amplitude, std::size_t n, double offset = 0.0) {
  std::vector<double> x(n);
  for (std::size_t i = 0; i < n; ++i) {
    x[i] =
        offset +
        amplitude * std::sin(2.0 * std::numbers::pi * order * static_cast<double>(i) / kSamplesPerTurn + 0.4);
  }
  return x;
}

TEST(OrderBandEnergies, HoldHalfTheSquareOfATonesAmplitudeInItsBand) {
  const OrderBands bands;
  for (const auto& [order, band] : {std::pair{1.0, 0U}, {2.0, 1U}, {7.0, 6U}, {160.0, 18U}}) {
    const std::vector<double> energies =
        OrderBandEnergies(Tone(order, 3.0, 40000, 100.0), kSamplesPerTurn, bands);
    ASSERT_GT(energies.size(), band);
    EXPECT_FALSE(std::isnan(energies[band])) << order;
    for (std::size_t i = 0; i < energies.size(); ++i) {
      if (std::isnan(energies[i])) continue;
      // What a Hann window lets through half an order away is below one in a hundred thousand.
      EXPECT_NEAR(energies[i], i == band ? 4.5 : 0.0, 1e-3) << order << " band " << i;
    }
  }
}

TEST(OrderBandEnergies, AddUpToTheVarianceOfNoise) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(7.0, 2.0);
  std::vector<double> x(200000);
  for (double& value : x) value = normal(random);
  const std::vector<double> energies =
      OrderBandEnergies(x, kSamplesPerTurn, {.edges = {0.0, 3.0, 50.0, 258.6}});
  // 48 half-overlapping segments: the variance of 200 000 values is known to a third of a percent.
  EXPECT_NEAR(std::accumulate(energies.begin(), energies.end(), 0.0), 4.0, 0.06);
}

TEST(OrderBandEnergies, AreMissingAboveHalfTheSamplingRate) {
  const std::vector<double> energies = OrderBandEnergies(Tone(2.0, 1.0, 20000), kSamplesPerTurn, {});
  EXPECT_FALSE(std::isnan(energies[19]));  // up to order 240.5
  EXPECT_TRUE(std::isnan(energies[20]));   // up to 340.5, over 258.65
}

TEST(OrderBandNames, SayChannelAndOrders) {
  const std::vector<std::string> channels{"accel_x_m_per_s2", "current_A"};
  EXPECT_EQ(OrderBandNames(channels, {.edges = {0.5, 1.5, 16.0}}),
            (std::vector<std::string>{"accel_x_m_per_s2.orders.0.5_1.5", "accel_x_m_per_s2.orders.1.5_16",
                                      "current_A.orders.0.5_1.5", "current_A.orders.1.5_16"}));
}

TEST(OrderBandEnergies, SayWhatIsWrongWithTheirArguments) {
  const std::vector<double> x(1000, 1.0);
  EXPECT_EQ(MessageOf([&] { OrderBandEnergies(x, 500.0, {}); }),
            "signal has 2 turns of the input shaft (expected at least 4)");
  EXPECT_EQ(MessageOf([&] { OrderBandEnergies(x, 0.0, {}); }),
            "samples_per_turn = 0 is not a positive number");
  EXPECT_EQ(MessageOf([&] {
              OrderBandEnergies(x, 50.0, {.edges = {1.0, 1.0}});
            }),
            "bands.edges is not a rising series of at least two orders from 0 up");
}

}  // namespace
}  // namespace strainwave::analysis::features::order_bands_test
