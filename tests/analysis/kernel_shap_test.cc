// SPDX-License-Identifier: Apache-2.0
#include "analysis/explanation/kernel_shap.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "analysis/explanation/shapley.h"

namespace strainwave::analysis::explanation::kernel_shap_test {
namespace {

// A value drawn for each coalition: every interaction there can be.
std::vector<double> AnyGame(std::size_t players, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<double> table(std::size_t{1} << players);
  for (double& value : table) value = normal(engine);
  return table;
}

TEST(KernelShap, IsExactWhereAllCoalitionsFit) {
  for (std::size_t players = 1; players <= 11; ++players) {
    const std::vector<double> table = AnyGame(players, players);
    const KernelShapValues kernel =
        KernelShap(players, 1, [&](PlayerSet coalition, double* out) { *out = table[coalition]; });
    EXPECT_TRUE(kernel.all_coalitions);
    EXPECT_EQ(kernel.coalitions, (std::size_t{1} << players) - 2);
    const std::vector<double> exact =
        ShapleyValues(players, [&](Coalition coalition) { return table[coalition]; });
    for (std::size_t p = 0; p < players; ++p) {
      EXPECT_NEAR(kernel.shares[p], exact[p], 1e-9) << players << " players, player " << p;
      EXPECT_EQ(kernel.standard_errors[p], 0.0);
    }
  }
}

TEST(KernelShap, LiesWithinItsStandardErrorsWhereCoalitionsAreDrawn) {
  // A game that is smooth in who takes part, as models are, and one of noise; many seeds, so that the errors
  // are judged as errors: of Student's distribution with nine degrees 1.5 % lie beyond three, and the mean
  // square is 9/7. Over 300 seeds 1.9 % and 1.5 were seen.
  constexpr std::size_t kPlayers = 12;
  int beyond = 0;
  int all = 0;
  double squares = 0.0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> normal;
    std::vector<double> weights(kPlayers);
    for (double& weight : weights) weight = normal(engine);
    const std::vector<double> noise = AnyGame(kPlayers, seed);
    const auto value = [&](PlayerSet coalition) {
      double sum = 0.0;
      for (std::size_t p = 0; p < kPlayers; ++p) sum += ((coalition >> p) & 1U) != 0 ? weights[p] : 0.0;
      return 3.0 * std::tanh(sum) + 0.5 * sum * sum + 0.1 * noise[coalition];
    };
    const KernelShapValues kernel = KernelShap(
        kPlayers, 1, [&](PlayerSet coalition, double* out) { *out = value(coalition); }, {.seed = seed});
    EXPECT_FALSE(kernel.all_coalitions);
    EXPECT_LE(kernel.coalitions, 2 * kPlayers + 2048);
    const std::vector<double> exact = ShapleyValues(kPlayers, [&](Coalition c) { return value(c); });
    double sum = 0.0;
    for (std::size_t p = 0; p < kPlayers; ++p) {
      ASSERT_GT(kernel.standard_errors[p], 0.0);
      const double off = (kernel.shares[p] - exact[p]) / kernel.standard_errors[p];
      beyond += std::abs(off) > 3.0 ? 1 : 0;
      squares += off * off;
      ++all;
      sum += kernel.shares[p];
    }
    EXPECT_NEAR(sum, value((1U << kPlayers) - 1) - value(0), 1e-9);
  }
  // Ten parts give the errors themselves only to a quarter.
  EXPECT_LE(beyond, 25) << "of " << all;
  EXPECT_GT(squares / all, 0.8);
  EXPECT_LT(squares / all, 2.0);
}

TEST(KernelShap, SharesALinearModelByItsWeightsAndLeavesADummyNothing) {
  // 18 players, of which the last plays no part: far more coalitions than are drawn.
  constexpr std::size_t kPlayers = 18;
  const KernelShapValues kernel = KernelShap(kPlayers, 2, [&](PlayerSet coalition, double* out) {
    out[0] = 5.0;
    for (std::size_t p = 0; p + 1 < kPlayers; ++p)
      out[0] += static_cast<double>((coalition >> p) & 1U) * static_cast<double>(p + 1);
    out[1] = -out[0];
  });
  for (std::size_t p = 0; p < kPlayers; ++p) {
    const double expected = p + 1 < kPlayers ? static_cast<double>(p + 1) : 0.0;
    EXPECT_NEAR(kernel.shares[2 * p], expected, 1e-9) << p;
    EXPECT_NEAR(kernel.shares[2 * p + 1], -expected, 1e-9) << p;
    EXPECT_NEAR(kernel.standard_errors[2 * p], 0.0, 1e-9) << p;
  }
}

TEST(KernelShap, GivesTheSameBitsForTheSameSeed) {
  const std::vector<double> table = AnyGame(13, 5);
  const auto value = [&](PlayerSet coalition, double* out) { *out = table[coalition]; };
  const KernelShapValues one = KernelShap(13, 1, value, {.coalitions = 500, .seed = 3});
  EXPECT_EQ(one.shares, KernelShap(13, 1, value, {.coalitions = 500, .seed = 3}).shares);
  EXPECT_NE(one.shares, KernelShap(13, 1, value, {.coalitions = 500, .seed = 4}).shares);
  EXPECT_THROW(KernelShap(0, 1, value), std::invalid_argument);
  EXPECT_THROW(KernelShap(65, 1, value), std::invalid_argument);
}

}  // namespace
}  // namespace strainwave::analysis::explanation::kernel_shap_test
