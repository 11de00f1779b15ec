// SPDX-License-Identifier: Apache-2.0
#include "analysis/features/envelope_orders.h"

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/bearing_orders.h"
#include "analysis/features/envelope_prominence.h"

namespace strainwave::analysis::features::envelope_orders_test {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// A carrier of so many cycles a sample whose amplitude swings `order` times a turn, in a little noise.
std::vector<double> Modulated(double order, double samples_per_turn, double turns, double carrier,
                              double gain) {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal(0.0, 0.02);
  std::vector<double> signal(static_cast<std::size_t>(turns * samples_per_turn));
  for (std::size_t i = 0; i < signal.size(); ++i) {
    const auto at = static_cast<double>(i);
    const double swing = 1.0 + 0.8 * std::cos(kTurn * order * at / samples_per_turn);
    signal[i] = gain * (swing * std::sin(kTurn * carrier * at) + normal(engine));
  }
  return signal;
}

std::size_t BandOf(double order) { return static_cast<std::size_t>((order - 0.25) / 0.5); }

TEST(EnvelopeOrders, FindHowOftenATurnTheAmplitudeSwings) {
  for (const double order : {2.0, 3.5, 5.4}) {
    for (const double samples_per_turn : {800.0, 1300.0}) {
      const OrderBands bands = EnvelopeOrderBands(samples_per_turn);
      const std::vector<double> shares =
          EnvelopeOrderShares(Modulated(order, samples_per_turn, 12.0, 0.2, 1.0), samples_per_turn, bands);
      EXPECT_GT(std::exp(shares[BandOf(order)]), 0.95) << order << " at " << samples_per_turn;
    }
  }
}

TEST(EnvelopeOrders, SharesAddUpToOneAndKnowNoGain) {
  const OrderBands bands = EnvelopeOrderBands(500.0);
  const std::vector<double> one = EnvelopeOrderShares(Modulated(3.0, 500.0, 8.0, 0.3, 1.0), 500.0, bands);
  const std::vector<double> loud = EnvelopeOrderShares(Modulated(3.0, 500.0, 8.0, 0.3, 50.0), 500.0, bands);
  double sum = 0.0;
  for (std::size_t k = 0; k < one.size(); ++k) {
    sum += std::exp(one[k]);
    EXPECT_NEAR(one[k], loud[k], 1e-6);
  }
  EXPECT_NEAR(sum, 1.0, 1e-9);
}

TEST(EnvelopeOrders, ATwelfthOfNyquistIsTheLowestCarrier) {
  // A strong slow tone, far below the carriers, changes nothing.
  const OrderBands bands = EnvelopeOrderBands(600.0);
  std::vector<double> signal = Modulated(4.0, 600.0, 10.0, 0.25, 1.0);
  const std::vector<double> alone = EnvelopeOrderShares(signal, 600.0, bands);
  for (std::size_t i = 0; i < signal.size(); ++i)
    signal[i] += 20.0 * std::sin(kTurn * 0.01 * static_cast<double>(i));
  const std::vector<double> with = EnvelopeOrderShares(signal, 600.0, bands);
  EXPECT_NEAR(with[BandOf(4.0)], alone[BandOf(4.0)], 0.01);
}

TEST(EnvelopeOrders, ALineStandsOutWhereItIs) {
  const std::vector<double> orders{3.5848, 5.4152, 4.7135, 0.39828};
  const std::vector<double> signal = Modulated(3.55, 900.0, 150.0, 0.2, 1.0);  // a hundredth of slip
  const std::vector<double> found = EnvelopeProminences_dB(signal, 900.0, orders);
  EXPECT_GT(found[0], 30.0);
  EXPECT_LT(found[1], 20.0);
  EXPECT_LT(found[2], 20.0);
  // The cage is slow: short records hold few lines about it.
  EXPECT_TRUE(std::isfinite(found[3]));
  EXPECT_TRUE(std::isnan(EnvelopeProminences_dB(Modulated(3.55, 900.0, 5.0, 0.2, 1.0), 900.0, orders)[3]));
}

TEST(EnvelopeOrders, BandsReachAsFarAsTheSampling) {
  EXPECT_EQ(EnvelopeOrderBands(5120.0).edges.size(), 41U);
  EXPECT_DOUBLE_EQ(EnvelopeOrderBands(5120.0).edges.back(), 20.25);
  EXPECT_DOUBLE_EQ(EnvelopeOrderBands(10.0).edges.back(), 4.75);
  EXPECT_TRUE(EnvelopeOrderBands(2.0).edges.empty());
}

TEST(EnvelopeOrders, RefuseATooShortRecord) {
  try {
    EnvelopeOrderShares(std::vector<double>(399, 1.0), 100.0, EnvelopeOrderBands(100.0));
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "signal has 3.99 turns of the input shaft (expected at least 4)");
  }
}

// SKF 6205-2RS: 9 balls of 7.94 mm on 39.04 mm. Orders as the Bearing Data Center of Case Western Reserve
// University publishes them.
TEST(BearingOrdersOf, AgreeWithPublishedOnes) {
  const BearingOrders orders = BearingOrdersOf({9, 7.94e-3, 39.04e-3, 0.0});
  EXPECT_NEAR(orders.inner_race, 5.4152, 1e-4);
  EXPECT_NEAR(orders.outer_race, 3.5848, 1e-4);
  EXPECT_NEAR(orders.element, 4.7135, 1e-4);
  EXPECT_NEAR(orders.cage, 0.39828, 1e-4);
  EXPECT_DOUBLE_EQ(orders.inner_race + orders.outer_race, 9.0);
}

TEST(BearingOrdersOf, RefuseWhatIsNoBearing) {
  const auto message = [](const RollingBearing& bearing) -> std::string {
    try {
      BearingOrdersOf(bearing);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message({0, 1e-3, 2e-3, 0.0}), "elements = 0 is not a positive number");
  EXPECT_EQ(message({9, 0.04, 0.03, 0.0}), "element_diameter_m = 0.04 is not below pitch_diameter_m = 0.03");
  EXPECT_EQ(message({9, 0.01, 0.03, 1.6}), "contact_angle_rad = 1.6 is not in 0 to below π/2");
}

}  // namespace
}  // namespace strainwave::analysis::features::envelope_orders_test
