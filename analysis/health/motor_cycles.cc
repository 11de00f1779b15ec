// SPDX-License-Identifier: Apache-2.0
#include "analysis/health/motor_cycles.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/arguments.h"

namespace strainwave::analysis::health {
namespace {

// Chatter of the signal for a few rows is no edge.
constexpr std::size_t kShortestRun = 3;
constexpr std::size_t kMostMoves = 8;
constexpr double kComesBack = 0.1;  // of the way of the longest move

std::vector<std::size_t> RisingEdges(std::span<const double> state) {
  const auto [low, high] = std::ranges::minmax(state);
  const double middle = low + 0.5 * std::min(1.0, high - low);
  std::vector<std::size_t> edges;
  std::size_t rest = 0;  // rows of rest before
  bool moves = state[0] > middle;
  for (std::size_t i = 1; i < state.size(); ++i) {
    if (state[i] > middle) {
      if (!moves && rest >= kShortestRun) edges.push_back(i);
      moves = true;
      rest = 0;
    } else {
      ++rest;
      if (rest >= kShortestRun) moves = false;
    }
  }
  return edges;
}

// How many moves it takes to be back, each from its edge to the next or the end; 1 where the shaft never
// comes back.
std::size_t MovesBack(const std::vector<std::size_t>& edges, std::span<const double> velocity) {
  std::vector<double> ways;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const std::size_t end = k + 1 < edges.size() ? edges[k + 1] : velocity.size();
    double way = 0.0;
    for (std::size_t i = edges[k]; i < end; ++i) way += velocity[i];
    ways.push_back(way);
  }
  double longest = 0.0;
  for (const double way : ways) longest = std::max(longest, std::abs(way));
  for (std::size_t moves = 2; moves <= std::min(kMostMoves, ways.size()); ++moves) {
    // The record may end within the last one.
    const std::size_t whole = ways.size() > moves ? ways.size() - 1 : ways.size();
    double worst = 0.0;
    for (std::size_t k = 0; k + moves <= whole; ++k) {
      double sum = 0.0;
      for (std::size_t j = 0; j < moves; ++j) sum += ways[k + j];
      worst = std::max(worst, std::abs(sum));
    }
    if (worst < kComesBack * longest) return moves;
  }
  return 1;
}

}  // namespace

MotorCycles CutCycles(std::span<const double> state, std::span<const double> velocity) {
  MotorCycles result{{{0, velocity.size()}}, 0, "taken whole"};
  if (state.empty()) return result;
  RequireSameLength("state", state, "velocity", velocity);
  const auto [low, high] = std::ranges::minmax(state);
  if (!(high > low)) return result;
  const std::vector<std::size_t> edges = RisingEdges(state);
  if (edges.size() < 2) return result;
  const std::size_t moves = MovesBack(edges, velocity);
  // The last cycle ends with the record where that is as long as the others.
  std::vector<std::size_t> begins;
  for (std::size_t k = 0; k < edges.size(); k += moves) begins.push_back(edges[k]);
  std::vector<CycleRows> cycles;
  for (std::size_t k = 0; k + 1 < begins.size(); ++k)
    cycles.push_back({begins[k], begins[k + 1] - begins[k]});
  if (cycles.empty()) return result;
  const std::size_t left = velocity.size() - begins.back();
  constexpr double kAsLong = 0.98;
  const bool whole_moves = edges.size() % moves == 0;
  if (whole_moves && static_cast<double>(left) >= kAsLong * static_cast<double>(cycles.back().count))
    cycles.push_back({begins.back(), std::min(left, cycles.back().count)});
  result.moves_a_cycle = static_cast<int>(moves);
  result.note = fmt::format("cut into {} cycles of {} moves at the edges of state", cycles.size(), moves);
  result.cycles = std::move(cycles);
  return result;
}

}  // namespace strainwave::analysis::health
