// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/holds.h"

#include <algorithm>
#include <cmath>

namespace strainwave::analysis::diagnosis {
namespace {

constexpr std::size_t kPiece = 8;
constexpr std::size_t kShortest = 8 * kPiece;
// Standard errors: a hold has many pieces, of which none should break it off by chance; a slow ramp has many
// places that one might take for a hold.
constexpr double kBeyondNoise = 4.0;
constexpr double kSlopes = 2.0;

// Means of stretches of a signal, from running sums about its first value.
class Means {
 public:
  explicit Means(std::span<const double> signal) : about_(signal[0]), sums_(signal.size() + 1, 0.0) {
    for (std::size_t i = 0; i < signal.size(); ++i) sums_[i + 1] = sums_[i] + signal[i] - about_;
  }
  double Of(std::size_t first, std::size_t end) const {
    return about_ + (sums_[end] - sums_[first]) / static_cast<double>(end - first);
  }

 private:
  double about_;
  std::vector<double> sums_;
};

// A piece of a signal beside, or within, a longer stretch of it.
bool Agrees(const Means& means, std::size_t piece, std::size_t first, std::size_t end, double noise) {
  const double error =
      noise * std::sqrt(1.0 / static_cast<double>(kPiece) + 1.0 / static_cast<double>(end - first));
  return std::abs(means.Of(piece, piece + kPiece) - means.Of(first, end)) <= kBeyondNoise * error;
}

// Some of the outermost samples are the ramp's, which a whole piece hides.
bool EndStandsOff(const Means& means, std::size_t outermost, int inwards, double level, double noise) {
  constexpr double kBeside = 2.5;  // standard errors: to lose a few of the hold's own costs nothing
  for (std::size_t count = 1; count <= kPiece; ++count) {
    const double mean =
        inwards > 0 ? means.Of(outermost, outermost + count) : means.Of(outermost - count, outermost);
    if (std::abs(mean - level) > kBeside * noise / std::sqrt(static_cast<double>(count))) return true;
  }
  return false;
}

// Both halves have one mean, and so has each piece.
bool IsLevel(const Means& means, std::size_t first, double noise) {
  const std::size_t end = first + kShortest;
  const std::size_t middle = first + kShortest / 2;
  const double error = 2.0 * noise / std::sqrt(static_cast<double>(kShortest));
  if (std::abs(means.Of(first, middle) - means.Of(middle, end)) > kSlopes * error) return false;
  for (std::size_t piece = first; piece < end; piece += kPiece) {
    if (!Agrees(means, piece, first, end, noise)) return false;
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
  const Means means(signal);
  for (std::size_t first = 0; first + kShortest <= signal.size();) {
    if (!IsLevel(means, first, noise)) {
      ++first;
      continue;
    }
    std::size_t end = first + kShortest;
    while (end + kPiece <= signal.size() && Agrees(means, end, first, end, noise)) end += kPiece;
    const double level = means.Of(first, end);
    std::size_t last = end;
    while (first + kPiece < last && EndStandsOff(means, first, 1, level, noise)) ++first;
    while (first + kPiece < last && EndStandsOff(means, last, -1, level, noise)) --last;
    holds.push_back({first, last, means.Of(first, last)});
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
