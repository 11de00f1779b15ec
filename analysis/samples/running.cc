// SPDX-License-Identifier: Apache-2.0
#include "analysis/samples/running.h"

#include <algorithm>
#include <cmath>

#include "analysis/noise_level.h"
#include "analysis/units.h"

namespace strainwave::analysis::samples {
namespace {

Segment LongestTurning(const std::vector<bool>& stands) {
  Segment longest;
  for (std::size_t i = 0; i < stands.size();) {
    std::size_t end = i;
    while (end < stands.size() && stands[end] == stands[i]) ++end;
    if (!stands[i] && end - i > longest.end - longest.first) longest = {i, end};
    i = end;
  }
  return longest;
}

// Half the squares that the lines at 1 and 2 per turn have in rows of whole turns.
double LineSquares(std::span<const double> values, double rows_per_turn) {
  double mean = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  double squares = 0.0;
  for (const double order : {1.0, 2.0}) {
    double cosine = 0.0;
    double sine = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double angle = kTwoPi * order * static_cast<double>(i) / rows_per_turn;
      cosine += (values[i] - mean) * std::cos(angle);
      sine += (values[i] - mean) * std::sin(angle);
    }
    squares += 2.0 * (cosine * cosine + sine * sine) / static_cast<double>(values.size());
  }
  return squares;
}

// The middle one of each and its neighbours.
std::vector<double> MediansOfThree(const std::vector<double>& values) {
  std::vector<double> medians = values;
  for (std::size_t i = 1; i + 1 < values.size(); ++i)
    medians[i] = Median({values[i - 1], values[i], values[i + 1]});
  return medians;
}

}  // namespace

Segment TurningBySpeed(std::span<const double> speed) {
  constexpr double kStands = 0.01;      // of the largest speed
  constexpr double kLeastShare = 0.02;  // of the rows
  double largest = 0.0;
  for (const double one : speed) largest = std::max(largest, std::abs(one));
  std::vector<bool> stands;
  for (const double one : speed) stands.push_back(std::abs(one) < kStands * largest);
  const auto standing = static_cast<double>(std::ranges::count(stands, true));
  if (standing < kLeastShare * static_cast<double>(speed.size())) return {0, speed.size()};
  return LongestTurning(stands);
}

Segment TurningByLines(std::span<const std::vector<double>> channels, double rows_per_turn) {
  constexpr double kBlocks = 80.0;         // at most: the more rows one has, the clearer are its lines
  constexpr double kFewestBlocks = 8.0;    // at least, to tell some from the others
  constexpr std::size_t kFewestGone = 3;   // of them, in one piece
  constexpr double kClear = 12.0;          // times what noise has there
  constexpr double kBeyondChance = 100.0;  // the same: at an end of the record one block will do
  constexpr double kGone = 3.0;        // the same; of a χ² with 4 degrees of freedom 2 % lie above, and of
                                       // its medians of three 0.1 %
  constexpr double kGoneShare = 0.15;  // of what the upper quartile of blocks has
  constexpr double kPerChannel = 4.0;  // squares that white noise of variance 1 has in two lines
  const std::size_t rows = channels.empty() ? 0 : channels.front().size();
  const double turns = std::ceil(std::max(1.0, static_cast<double>(rows) / kBlocks / rows_per_turn));
  const double block_rows = turns * rows_per_turn;
  const Segment all{0, rows};
  if (static_cast<double>(rows) < kFewestBlocks * block_rows) return all;
  const auto blocks = static_cast<std::size_t>(static_cast<double>(rows) / block_rows);
  const auto first_row = [&](std::size_t block) {
    return block == blocks ? rows
                           : static_cast<std::size_t>(std::lround(static_cast<double>(block) * block_rows));
  };
  std::vector<double> squares(blocks, 0.0);  // of what noise would have
  for (const std::vector<double>& values : channels) {
    const double noise = EstimateNoise(values).standard_deviation;
    if (!(noise > 0.0)) continue;
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::size_t first = first_row(b);
      const auto own = std::span(values).subspan(first, static_cast<std::size_t>(block_rows));
      squares[b] += LineSquares(own, rows_per_turn) /
                    (noise * noise * kPerChannel * static_cast<double>(channels.size()));
    }
  }
  squares = MediansOfThree(squares);
  std::vector<double> sorted = squares;
  const auto quartile = sorted.begin() + static_cast<std::ptrdiff_t>(3 * blocks / 4);
  std::ranges::nth_element(sorted, quartile);
  if (*quartile < kClear) return all;
  std::vector<bool> gone;
  for (const double one : squares) gone.push_back(one < std::min(kGone, kGoneShare * *quartile));
  for (std::size_t b = 0; b < blocks;) {
    std::size_t end = b;
    while (end < blocks && gone[end] == gone[b]) ++end;
    const bool at_an_end = (b == 0 || end == blocks) && *quartile > kBeyondChance;
    if (gone[b] && end - b < kFewestGone && !at_an_end)
      std::fill(gone.begin() + static_cast<std::ptrdiff_t>(b),
                gone.begin() + static_cast<std::ptrdiff_t>(end), false);
    b = end;
  }
  if (std::ranges::none_of(gone, [](bool one) { return one; })) return all;
  Segment turning = LongestTurning(gone);
  // The shaft starts and stops within a block, and chance may make the one beside it look alike.
  constexpr std::size_t kBeside = 2;
  if (turning.first > 0) turning.first = std::min(turning.first + kBeside, turning.end);
  if (turning.end < blocks) turning.end -= std::min(kBeside, turning.end - turning.first);
  return {first_row(turning.first), first_row(turning.end)};
}

}  // namespace strainwave::analysis::samples
