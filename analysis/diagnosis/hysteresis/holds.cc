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

// A piece of a signal beside, or within, a longer segment of it.
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

// What two parts of a segment differ by in their means, in standard errors.
double Contrast(double mean, double other_mean, std::size_t count, std::size_t other_count, double noise) {
  return std::abs(mean - other_mean) /
         (noise * std::sqrt(1.0 / static_cast<double>(count) + 1.0 / static_cast<double>(other_count)));
}

// Neither slopes nor bends: both halves have one mean, and so have its middle and its ends. A slow turn is as
// level as a hold, but for its bend.
bool HasNoTrend(const RunningSums& sums, std::size_t first, std::size_t end, double most, double noise) {
  const std::size_t count = end - first;
  const std::size_t middle = first + count / 2;
  const double slope =
      Contrast(MeanOf(sums, first, middle), MeanOf(sums, middle, end), count / 2, count - count / 2, noise);
  const std::size_t inner = first + count / 4;
  const std::size_t outer = end - count / 4;
  const double ends = 0.5 * (MeanOf(sums, first, inner) + MeanOf(sums, outer, end));
  const double bend =
      Contrast(MeanOf(sums, inner, outer), ends, outer - inner, count - (outer - inner), noise);
  return slope <= most && bend <= most;
}

// Without trend, and each piece has the mean of all.
bool IsLevel(const RunningSums& sums, std::size_t first, double noise) {
  const std::size_t end = first + kShortest;
  if (!HasNoTrend(sums, first, end, kSlopes, noise)) return false;
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

constexpr std::size_t kFewestOfStair = 5;
constexpr double kOffStair = 3.5;  // standard deviations
constexpr double kTrendOfStair = 3.0;

bool IsOff(double difference, double noise) { return std::abs(difference) > kOffStair * noise; }

// A segment without the samples at its ends that belong to the ways up and down, and with its mean.
Hold WithoutRiser(std::span<const double> signal, const RunningSums& sums, Hold stair, double noise) {
  constexpr double kBeside = 2.5;
  const auto stands_off = [&](std::size_t at, std::size_t rest_first, std::size_t rest_end) {
    return std::abs(signal[at] - MeanOf(sums, rest_first, rest_end)) > kBeside * noise;
  };
  while (stair.first + 2 < stair.end && stands_off(stair.first, stair.first + 1, stair.end)) ++stair.first;
  while (stair.first + 2 < stair.end && stands_off(stair.end - 1, stair.first, stair.end - 1)) --stair.end;
  stair.level = MeanOf(sums, stair.first, stair.end);
  return stair;
}

// A stair is come to and left at a stride, which no turn of a ramp is.
bool IsLeft(std::span<const double> signal, const Hold& stair, double noise) {
  constexpr std::size_t kStride = 2;
  constexpr double kFar = 10.0;  // standard deviations
  const auto goes = [&](std::size_t at) { return std::abs(signal[at] - stair.level) > kFar * noise; };
  const bool come_to = stair.first < kStride || goes(stair.first - kStride);
  const bool left = stair.end + kStride > signal.size() || goes(stair.end + kStride - 1);
  return come_to && left;
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
    while (end + kPiece <= signal.size() && Agrees(sums, end, first, end, noise) &&
           HasNoTrend(sums, first, end + kPiece, kBeyondNoise, noise)) {
      end += kPiece;
    }
    const double level = MeanOf(sums, first, end);
    std::size_t last = end;
    while (first + kPiece < last && EndStandsOff(sums, first, 1, level, noise)) ++first;
    while (first + kPiece < last && EndStandsOff(sums, last, -1, level, noise)) --last;
    holds.push_back({first, last, MeanOf(sums, first, last)});
    first = end;
  }
  return holds;
}

std::vector<Hold> FindStairs(std::span<const double> signal, double noise) {
  std::vector<Hold> stairs;
  if (signal.size() < kFewestOfStair || !(noise > 0.0)) return stairs;
  const RunningSums sums = RunningSumsOf(std::vector<double>(signal.size(), 1.0), signal);
  for (std::size_t first = 0; first + kFewestOfStair <= signal.size(); ++first) {
    if (first > 0 && std::abs(signal[first] - signal[first - 1]) <= kOffStair * noise) continue;
    std::size_t end = first + 1;
    // One that stands off alone does not end it.
    while (end < signal.size()) {
      const double level = MeanOf(sums, first, end);
      const bool last = end + 1 == signal.size();
      if (IsOff(signal[end] - level, noise) && (last || IsOff(signal[end + 1] - level, noise))) break;
      ++end;
    }
    const Hold stair = WithoutRiser(signal, sums, {first, end, 0.0}, noise);
    if (stair.end < stair.first + kFewestOfStair) continue;
    if (IsLeft(signal, stair, noise) && HasNoTrend(sums, stair.first, stair.end, kTrendOfStair, noise))
      stairs.push_back(stair);
    first = stair.end - 1;
  }
  return stairs;
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
