// SPDX-License-Identifier: Apache-2.0
#include "analysis/explanation/network_game.h"

#include <bit>
#include <stdexcept>
#include <utility>
#include <variant>

#include "analysis/networks/activation.h"
#include "analysis/products.h"

namespace strainwave::analysis::explanation {
namespace {

Eigen::Map<const NetworkGame::Rows> WeightsOf(const networks::Network::Stage& stage,
                                              const networks::Vector<double>& parameters) {
  return {parameters.data() + stage.weights_begin, stage.output.size(), stage.input.size()};
}

auto BiasesOf(const networks::Network::Stage& stage, const networks::Vector<double>& parameters) {
  return parameters.segment(stage.weights_begin + stage.weights, stage.biases);
}

void RequireGroups(const std::vector<std::vector<Eigen::Index>>& groups, Eigen::Index inputs) {
  if (groups.empty() || groups.size() > kMostPlayers)
    throw std::invalid_argument("a game needs 1 to 64 groups of inputs");
  std::vector<bool> taken(static_cast<std::size_t>(inputs), false);
  for (const std::vector<Eigen::Index>& group : groups) {
    for (const Eigen::Index input : group) {
      if (input < 0 || input >= inputs || taken[static_cast<std::size_t>(input)])
        throw std::invalid_argument("a group names an input that is not there, or one that another has");
      taken[static_cast<std::size_t>(input)] = true;
    }
  }
}

}  // namespace

NetworkGame::NetworkGame(const networks::Network& network, const networks::Vector<double>& parameters,
                         std::vector<std::vector<Eigen::Index>> groups, Eigen::MatrixXd background,
                         Finish finish)
    : network_(network),
      parameters_(parameters),
      groups_(std::move(groups)),
      background_(std::move(background)),
      finish_(std::move(finish)),
      changes_(groups_.size()) {
  for (const networks::Network::Stage& stage : network_.stages()) {
    if (!std::holds_alternative<networks::Dense>(stage.layer))
      throw std::invalid_argument("a network with a layer that is not dense");
  }
  RequireGroups(groups_, network_.input_size());
  if (background_.cols() == 0 || background_.rows() != network_.input_size())
    throw std::invalid_argument("a background of no rows, or of other inputs than the network's");
  const networks::Network::Stage& first = network_.stages().front();
  start_ = WeightsOf(first, parameters_) * background_;
  start_.colwise() += BiasesOf(first, parameters_);
  sums_ = start_;
}

void NetworkGame::SetSample(const Eigen::VectorXd& sample) {
  if (sample.size() != network_.input_size())
    throw std::invalid_argument("a sample of another number of inputs than the network's");
  const auto weights = WeightsOf(network_.stages().front(), parameters_);
  for (std::size_t p = 0; p < groups_.size(); ++p) {
    const std::vector<Eigen::Index>& group = groups_[p];
    const Eigen::MatrixXd apart = (-background_(group, Eigen::all)).colwise() + sample(group);
    changes_[p] = weights(Eigen::all, group) * apart;
  }
  sums_ = start_;
  at_ = 0;
}

void NetworkGame::Value(PlayerSet players, double* outputs) {
  if (players == 0) {
    sums_ = start_;  // what rounding has left of earlier additions goes
  } else {
    for (PlayerSet differing = players ^ at_; differing != 0; differing &= differing - 1) {
      const auto p = static_cast<std::size_t>(std::countr_zero(differing));
      if (((players >> p) & 1U) != 0) {
        sums_ += changes_[p];
      } else {
        sums_ -= changes_[p];
      }
    }
  }
  at_ = players;
  layer_ = sums_;
  const std::vector<networks::Network::Stage>& stages = network_.stages();
  for (std::size_t s = 0; s < stages.size(); ++s) {
    if (s > 0) {
      const auto biases = BiasesOf(stages[s], parameters_);
      next_ = biases.replicate(1, layer_.cols());
      CombineRows<double>({parameters_.data() + stages[s].weights_begin, layer_.rows(), 1},
                          {layer_.data(), layer_.cols()}, {next_.data(), next_.cols()}, next_.rows(),
                          layer_.rows(), next_.cols(), Sum::kAdd);
      layer_.swap(next_);
    }
    networks::Activate(std::get<networks::Dense>(stages[s].layer).activation, layer_);
  }
  if (finish_) finish_(layer_);
  Eigen::Map<Eigen::VectorXd>(outputs, layer_.rows()) = layer_.rowwise().mean();
}

}  // namespace strainwave::analysis::explanation
