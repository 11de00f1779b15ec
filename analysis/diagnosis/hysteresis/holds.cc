// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/holds.h"

#include <algorithm>
#include <cmath>

#include "analysis/diagnosis/hysteresis/jumps.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr std::size_t kPiece = 8;
constexpr std::size_t kShortest = 8 * kPiece;
// Standard errors: a hold has many pieces, of which none should break it off by chance; a slow ramp has many
// places that one might take for a hold.
constexpr double kBeyondNoise = 4.0;
constexpr double kSlopes = 2.0;

double MeanOf(const RunningSums& sums, std::size_t first, std::size_t end) {
  return (sums.sum[end] - sums.sum[first]) / (sums.weight[end] - sums.weight[first]);
}

// A piece of a signal beside, or within, a longer stretch of it.
bool Agrees(const RunningSums& sums, std::size_t piece, std::size_t first, std::size_t end, double noise) {
  const double error =
      noise * std::sqrt(1.0 / static_cast<double>(kPiece) + 1.0 / static_cast<double>(end - first));
  return std::abs(MeanOf(sums, piece, piece + kPiece) - MeanOf(sums, first, end)) <= kBeyondNoise * error;
}

// Some of the outermost samples are the ramp's, which a whole piece hides.
bool EndStandsOff(const RunningSums& sums, std::size_t outermost, int inwards, double level, double noise) {
  constexpr double kBeside = 2.5;  // standard errors: to lose a few of the hold's own costs nothing
  for (std::size_t count = 1; count <= kPiece; ++count) {
    const double mean =
        inwards > 0 ? MeanOf(sums, outermost, outermost + count) : MeanOf(sums, outermost - count, outermost);
    if (std::abs(mean - level) > kBeside * noise / std::sqrt(static_cast<double>(count))) return true;
  }
  return false;
}

// Both halves have one mean, and so has each piece.
bool IsLevel(const RunningSums& sums, std::size_t first, double noise) {
  const std::size_t end = first + kShortest;
  const std::size_t middle = first + kShortest / 2;
  const double error = 2.0 * noise / std::sqrt(static_cast<double>(kShortest));
  if (std::abs(MeanOf(sums, first, middle) - MeanOf(sums, middle, end)) > kSlopes * error) return false;
  for (std::size_t piece = first; piece < end; piece += kPiece) {
    if (!Agrees(sums, piece, first, end, noise)) return false;
  }
  return true;
}

// What a ramp goes too far, outwards from the hold that it ends or begins in: cleaned of noise one sample by
// itself may still stand off by as much as it did.
void EndRampAt(std::span<double> values, std::size_t nearest, int outwards, double level, double noise) {
  constexpr std::size_t kAway = 2 * kPiece;
  constexpr double kBeyond = 3.0;
  const std::size_t room = outwards > 0 ? values.size() - 1 - nearest : nearest;
  const std::size_t away = std::min(kAway, room);
  const auto at = [&](std::size_t k) -> double& {
    return outwards > 0 ? values[nearest + k] : values[nearest - k];
  };
  const double side = at(away) > level ? 1.0 : -1.0;
  for (std::size_t k = 0; k <= away; ++k) {
    const double beyond = side * (level - at(k));
    if (beyond > 0.0 && beyond < kBeyond * noise) at(k) = level;
  }
}

}  // namespace

std::vector<Hold> FindHolds(std::span<const double> signal, double noise) {
  std::vector<Hold> holds;
  if (signal.size() < kShortest || !(noise > 0.0)) return holds;
  const RunningSums sums = RunningSumsOf(std::vector<double>(signal.size(), 1.0), signal);
  for (std::size_t first = 0; first + kShortest <= signal.size();) {
    if (!IsLevel(sums, first, noise)) {
      ++first;
      continue;
    }
    std::size_t end = first + kShortest;
    while (end + kPiece <= signal.size() && Agrees(sums, end, first, end, noise)) end += kPiece;
    const double level = MeanOf(sums, first, end);
    std::size_t last = end;
    while (first + kPiece < last && EndStandsOff(sums, first, 1, level, noise)) ++first;
    while (first + kPiece < last && EndStandsOff(sums, last, -1, level, noise)) --last;
    holds.push_back({first, last, MeanOf(sums, first, last)});
    first = end;
  }
  return holds;
}

void KeepStill(std::span<const Hold> holds, double noise, CleanSignal& clean) {
  for (const Hold& hold : holds) {
    const std::size_t count = hold.end - hold.first;
    std::ranges::fill(std::span(clean.values).subspan(hold.first, count), hold.level);
    std::ranges::fill(std::span(clean.errors).subspan(hold.first, count),
                      noise / std::sqrt(static_cast<double>(count)));
    if (hold.first > 0) EndRampAt(clean.values, hold.first - 1, -1, hold.level, noise);
    if (hold.end < clean.values.size()) EndRampAt(clean.values, hold.end, 1, hold.level, noise);
  }
}

}  // namespace strainwave::analysis::diagnosis
