// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace strainwave::analysis::explanation {

/// A coalition of up to 32 players: bit p is 1 where player p takes part.
using Coalition = std::uint32_t;

/// More than these players would need more than 2²⁰ values of a game.
inline constexpr std::size_t kMostExactPlayers = 20;

/// The Shapley value of each player of a game: the mean of what it adds, over all orders in which the players
/// may come. They sum to v(all) − v(none).
///
///   φ_p = Σ over S without p of |S|! (n − |S| − 1)! / n! · (v(S ∪ {p}) − v(S))
///
/// @param value  v of each coalition, called once for each of the 2ⁿ, in Gray-code order: from one call to
/// the
///   next one player comes or goes, so that a model may update what it has.
/// @throws std::invalid_argument if there are more than `kMostExactPlayers`.
///
/// Source: docs/sources.md#shapley-1953.
std::vector<double> ShapleyValues(std::size_t players, const std::function<double(Coalition)>& value);

/// The same of a game whose values are vectors: v(S) = outputs values; φ as players × outputs, row by row.
/// @param value  writes v(S) into its second argument, which has `outputs` values.
std::vector<double> ShapleyValues(std::size_t players, std::size_t outputs,
                                  const std::function<void(Coalition, double*)>& value);

/// The weight |S|! (n − |S| − 1)! / n! of a coalition of `size` without the player, of n players.
double ShapleyWeight(std::size_t players, std::size_t size);

}  // namespace strainwave::analysis::explanation
