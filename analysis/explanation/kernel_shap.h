// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "analysis/explanation/network_game.h"

namespace strainwave::analysis::explanation {

struct KernelShapSettings {
  std::size_t coalitions{};  // beside the empty and the full one; 0: 2 · players + 2048
  std::uint64_t seed{1};
};

struct KernelShapValues {
  std::vector<double> shares;  // players × outputs, row by row; of each output they sum to v(all) − v(none)
  std::vector<double> standard_errors;  // the same shape; of the sampling, 0 where nothing was sampled
  std::size_t coalitions{};             // that were looked at, without the empty and the full one
  bool all_coalitions{};                // then the shares are the exact Shapley values
};

/// Shapley values as the solution of a weighted regression of v(S) on who takes part. Coalitions are taken
/// from both ends, the smallest and the largest sizes first, as long as whole sizes fit; of the rest as many
/// as are left are drawn, each with its complement, so that what is odd in a game has no error. Nothing is
/// set to zero.
///
/// @param value  writes v(S), `outputs` values.
/// @throws std::invalid_argument for fewer than 1 or more than `kMostPlayers` players.
///
/// Source: docs/sources.md#lundberg-2017 for the regression, docs/sources.md#covert-2021 for pairs and
/// errors; the errors are from how far solutions of parts of the draws lie apart.
KernelShapValues KernelShap(std::size_t players, std::size_t outputs,
                            const std::function<void(PlayerSet, double*)>& value,
                            const KernelShapSettings& settings = {});

}  // namespace strainwave::analysis::explanation
