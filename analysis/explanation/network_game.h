// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "analysis/networks/network.h"

namespace strainwave::analysis::explanation {

/// Who takes part, bit p for player p, of up to 64.
using PlayerSet = std::uint64_t;
inline constexpr std::size_t kMostPlayers = 64;

/// A network of dense layers as a game: players are groups of inputs, and v(S) is the mean of the outputs
/// over a background, where the inputs of S are those of the sample and all others those of a background row.
///
/// Inputs are replaced independently of each other ('interventional'): where inputs depend on each other, as
/// a joint's position, velocity and acceleration do, one group for them is the unit that stays possible.
///
/// The first layer is linear, so the product of its weights with each group, of sample and background, is
/// kept: a coalition that differs from the last one by one player costs an addition in place of a product.
class NetworkGame {
 public:
  /// Values of units in rows, side by side for all background rows.
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  /// Changes outputs (outputs × background rows) before they are averaged: a softmax, for instance.
  using Finish = std::function<void(Rows& outputs)>;

  /// @param groups      of input numbers, one a player, each input in one group at most; an input in none
  /// stays
  ///   as the background has it.
  /// @param background  inputs × rows, scaled as the network takes them.
  /// @throws std::invalid_argument if a layer is not dense, a group names no input or one twice, there are no
  /// or
  ///   more than `kMostPlayers` groups, or no background row.
  NetworkGame(const networks::Network& network, const networks::Vector<double>& parameters,
              std::vector<std::vector<Eigen::Index>> groups, Eigen::MatrixXd background, Finish finish = {});

  std::size_t players() const { return groups_.size(); }
  std::size_t outputs() const { return static_cast<std::size_t>(network_.output_size()); }

  /// Whom the next calls of `Value` are about. @param sample  one value an input, scaled.
  void SetSample(const Eigen::VectorXd& sample);
  /// Writes v(S).
  void Value(PlayerSet players, double* outputs);

 private:
  const networks::Network& network_;
  const networks::Vector<double>& parameters_;
  std::vector<std::vector<Eigen::Index>> groups_;
  Eigen::MatrixXd background_;
  Finish finish_;
  Rows start_;                 // the first layer's sums of the background
  std::vector<Rows> changes_;  // by each player, of the sample
  Rows sums_;                  // of `at_`
  PlayerSet at_{};
  Rows layer_;
  Rows next_;
};

}  // namespace strainwave::analysis::explanation
