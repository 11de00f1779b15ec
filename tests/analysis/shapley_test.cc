// SPDX-License-Identifier: Apache-2.0
#include "analysis/explanation/shapley.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace strainwave::analysis::explanation::shapley_test {
namespace {

// By another route: the mean over all orders of the players.
std::vector<double> ByOrders(std::size_t players, const std::function<double(Coalition)>& value) {
  std::vector<std::size_t> order(players);
  std::iota(order.begin(), order.end(), 0U);
  std::vector<double> shares(players, 0.0);
  double orders = 0.0;
  do {
    Coalition coalition = 0;
    for (const std::size_t p : order) {
      const double before = value(coalition);
      coalition |= Coalition{1} << p;
      shares[p] += value(coalition) - before;
    }
    orders += 1.0;
  } while (std::next_permutation(order.begin(), order.end()));
  for (double& share : shares) share /= orders;
  return shares;
}

TEST(Shapley, IsTheMeanOverAllOrders) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (std::size_t players = 1; players <= 7; ++players) {
    std::vector<double> table(std::size_t{1} << players);
    for (double& value : table) value = uniform(engine);
    const auto value = [&](Coalition coalition) { return table[coalition]; };
    const std::vector<double> shares = ShapleyValues(players, value);
    const std::vector<double> expected = ByOrders(players, value);
    double sum = 0.0;
    for (std::size_t p = 0; p < players; ++p) {
      EXPECT_NEAR(shares[p], expected[p], 1e-12) << players << " players, player " << p;
      sum += shares[p];
    }
    EXPECT_NEAR(sum, table.back() - table.front(), 1e-12);
  }
}

TEST(Shapley, OfAnExclusiveOrIsSharedAndADummyGetsNothing) {
  // v = a xor b; c plays no part. By hand: a and b add 1 or −1, each as often, but v(all) = v(none) = 0.
  const std::vector<double> exclusive = ShapleyValues(3, [](Coalition coalition) {
    return static_cast<double>((coalition & 1U) ^ ((coalition >> 1U) & 1U));
  });
  for (const double share : exclusive) EXPECT_NEAR(share, 0.0, 1e-15);
  // v = a and b: a half each.
  const std::vector<double> both =
      ShapleyValues(3, [](Coalition coalition) { return (coalition & 3U) == 3U ? 1.0 : 0.0; });
  EXPECT_NEAR(both[0], 0.5, 1e-15);
  EXPECT_NEAR(both[1], 0.5, 1e-15);
  EXPECT_NEAR(both[2], 0.0, 1e-15);
}

TEST(Shapley, GoesFromCoalitionToCoalitionByOnePlayer) {
  Coalition last = 0;
  std::size_t calls = 0;
  ShapleyValues(5, [&](Coalition coalition) {
    if (calls++ > 0) {
      EXPECT_EQ(std::popcount(coalition ^ last), 1);
    }
    last = coalition;
    return 0.0;
  });
  EXPECT_EQ(calls, 32U);
}

TEST(Shapley, OfVectorsIsThatOfEachOutput) {
  const auto first = [](Coalition coalition) { return std::sin(1.0 + coalition); };
  const auto second = [](Coalition coalition) { return std::cos(2.0 * coalition); };
  const std::vector<double> both = ShapleyValues(4, 2, [&](Coalition coalition, double* out) {
    out[0] = first(coalition);
    out[1] = second(coalition);
  });
  const std::vector<double> one = ShapleyValues(4, first);
  const std::vector<double> two = ShapleyValues(4, second);
  for (std::size_t p = 0; p < 4; ++p) {
    EXPECT_DOUBLE_EQ(both[2 * p], one[p]);
    EXPECT_DOUBLE_EQ(both[2 * p + 1], two[p]);
  }
}

TEST(Shapley, RefusesMorePlayersThanCanBeEnumerated) {
  try {
    ShapleyValues(21, [](Coalition) { return 0.0; });
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "Shapley values of 21 players (expected 20 at most)");
  }
}

}  // namespace
}  // namespace strainwave::analysis::explanation::shapley_test
