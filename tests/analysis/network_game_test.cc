// SPDX-License-Identifier: Apache-2.0
#include "analysis/explanation/network_game.h"

#include <gtest/gtest.h>

#include "analysis/explanation/expected_gradients.h"
#include "analysis/explanation/shapley.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::explanation::network_game_test {
namespace {

using networks::Activation, networks::Dense;

struct SmallNetwork {
  networks::Network network;
  networks::Vector<double> parameters;
  Eigen::MatrixXd background;
  Eigen::VectorXd sample;
};

SmallNetwork MakeNetwork(Activation activation, Eigen::Index rows) {
  networks::Network network(
      {{1, 6}, {Dense{9, activation}, Dense{7, activation}, Dense{2, Activation::kLinear}}});
  networks::Vector<double> parameters = networks::InitialParameters<double>(network, 3);
  std::srand(4);
  Eigen::MatrixXd background = Eigen::MatrixXd::Random(6, rows);
  Eigen::VectorXd sample = 2.0 * Eigen::VectorXd::Random(6);
  return {std::move(network), std::move(parameters), std::move(background), std::move(sample)};
}

// By another route: the inputs put together row by row, and the network as it runs anywhere else.
Eigen::VectorXd MeanOf(const SmallNetwork& small, const std::vector<Eigen::Index>& replaced) {
  Eigen::MatrixXd inputs = small.background;
  for (const Eigen::Index i : replaced) inputs.row(i).setConstant(small.sample(i));
  networks::Pass<double> pass;
  return networks::Forward<double>(small.network, small.parameters, inputs, pass).rowwise().mean();
}

const std::vector<std::vector<Eigen::Index>> kGroups{{0, 3}, {1, 4}, {2}};  // input 5 stays as it is

TEST(NetworkGame, IsTheMeanOfTheNetworkOverTheBackground) {
  for (const Activation activation : {Activation::kTanh, Activation::kRelu, Activation::kSigmoid}) {
    const SmallNetwork small = MakeNetwork(activation, 5);
    NetworkGame game(small.network, small.parameters, kGroups, small.background);
    game.SetSample(small.sample);
    // In an order in which several players come and go at once.
    for (const PlayerSet players : {0U, 5U, 2U, 7U, 1U, 6U, 3U, 4U}) {
      std::vector<Eigen::Index> replaced;
      for (std::size_t p = 0; p < kGroups.size(); ++p) {
        if (((players >> p) & 1U) != 0) replaced.insert(replaced.end(), kGroups[p].begin(), kGroups[p].end());
      }
      Eigen::VectorXd value(2);
      game.Value(players, value.data());
      EXPECT_LT((value - MeanOf(small, replaced)).cwiseAbs().maxCoeff(), 1e-13) << players;
    }
  }
}

TEST(NetworkGame, SharesSumToWhatIsExplained) {
  const SmallNetwork small = MakeNetwork(Activation::kTanh, 50);
  std::vector<std::vector<Eigen::Index>> each;
  for (Eigen::Index i = 0; i < 6; ++i) each.push_back({i});
  NetworkGame game(small.network, small.parameters, each, small.background);
  game.SetSample(small.sample);
  const std::vector<double> shares =
      ShapleyValues(6, 2, [&](Coalition coalition, double* out) { game.Value(coalition, out); });
  const Eigen::VectorXd explained = MeanOf(small, {0, 1, 2, 3, 4, 5}) - MeanOf(small, {});
  for (Eigen::Index o = 0; o < 2; ++o) {
    double sum = 0.0;
    for (std::size_t p = 0; p < 6; ++p) sum += shares[2 * p + static_cast<std::size_t>(o)];
    EXPECT_NEAR(sum, explained(o), 1e-9);
  }
}

TEST(NetworkGame, OfALinearNetworkSharesTheDistanceFromTheMean) {
  networks::Network network({{1, 3}, {Dense{1, Activation::kLinear}}});
  networks::Vector<double> parameters(4);
  parameters << 2.0, -1.0, 0.0, 7.0;  // weights, bias
  Eigen::MatrixXd background(3, 2);
  background << 0.0, 1.0, 4.0, 2.0, 5.0, 9.0;
  const Eigen::Vector3d sample{3.0, 1.0, 100.0};
  NetworkGame game(network, parameters, {{0}, {1}, {2}}, background);
  game.SetSample(sample);
  const std::vector<double> shares =
      ShapleyValues(3, 1, [&](Coalition coalition, double* out) { game.Value(coalition, out); });
  // w (x − mean): 2 (3 − 0.5), −(1 − 3), and an input without weight.
  EXPECT_NEAR(shares[0], 5.0, 1e-12);
  EXPECT_NEAR(shares[1], 2.0, 1e-12);
  EXPECT_NEAR(shares[2], 0.0, 1e-12);
}

TEST(NetworkGame, RefusesWhatIsNoGame) {
  const SmallNetwork small = MakeNetwork(Activation::kTanh, 2);
  const auto with = [&](std::vector<std::vector<Eigen::Index>> groups, Eigen::MatrixXd background) {
    return MessageOf([&] { NetworkGame(small.network, small.parameters, groups, background); });
  };
  EXPECT_EQ(with({}, small.background), "a game needs 1 to 64 groups of inputs");
  EXPECT_EQ(with({{0}, {0}}, small.background),
            "a group names an input that is not there, or one that another has");
  EXPECT_EQ(with({{6}}, small.background),
            "a group names an input that is not there, or one that another has");
  EXPECT_EQ(with({{0}}, Eigen::MatrixXd(6, 0)),
            "a background of no rows, or of other inputs than the network's");
}

TEST(ExpectedGradients, SumToWhatIsExplainedWithinTheirErrors) {
  const SmallNetwork small = MakeNetwork(Activation::kTanh, 20);
  const ExpectedGradients gradients =
      ExpectedGradientsOf(small.network, small.parameters, small.sample, small.background, 2000, 1);
  const Eigen::VectorXd explained = MeanOf(small, {0, 1, 2, 3, 4, 5}) - MeanOf(small, {});
  for (Eigen::Index o = 0; o < 2; ++o) {
    EXPECT_NEAR(gradients.shares.col(o).sum() + gradients.gap(o), explained(o), 1e-12);
    EXPECT_LT(std::abs(gradients.gap(o)), 3.0 * gradients.standard_errors.col(o).norm());
  }
  // Of a linear network they are exact whatever is drawn, as often as each background row is.
  networks::Network network({{1, 2}, {Dense{1, Activation::kLinear}}});
  networks::Vector<double> parameters(3);
  parameters << 2.0, -1.0, 7.0;
  Eigen::MatrixXd background(2, 2);
  background << 0.0, 1.0, 4.0, 2.0;
  const ExpectedGradients linear =
      ExpectedGradientsOf(network, parameters, Eigen::Vector2d{3.0, 1.0}, background, 10, 1);
  EXPECT_NEAR(linear.shares(0, 0), 5.0, 1e-12);
  EXPECT_NEAR(linear.shares(1, 0), 2.0, 1e-12);
  EXPECT_NEAR(linear.gap(0), 0.0, 1e-12);
}

}  // namespace
}  // namespace strainwave::analysis::explanation::network_game_test
