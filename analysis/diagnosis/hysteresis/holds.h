// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analysis/diagnosis/hysteresis/signal.h"

namespace strainwave::analysis::diagnosis {

/// Samples first <= i < end over which a signal stands still.
struct Hold {
  std::size_t first{};
  std::size_t end{};
  double level{};  // mean
};

/// Segments of 64 samples and more over which a signal is its mean and white noise: no slope, and no piece
/// of it that stands off. A parabola goes on bending where a smooth ramp ends, past what is then held.
/// @param noise  standard deviation of a sample; none are found where it is 0.
std::vector<Hold> FindHolds(std::span<const double> signal, double noise);

/// Segments of 5 samples and more that a signal comes to and leaves within two samples, and is its mean and
/// white noise between.
/// @param noise  standard deviation of a sample; none are found where it is 0.
std::vector<Hold> FindStairs(std::span<const double> signal, double noise);

/// Puts the signal at each hold's level there, and takes off what the ramps beside it go past that level by
/// noise: friction would keep it for as long as the hold lasts.
void KeepStill(std::span<const Hold> holds, double noise, CleanSignal& clean);

}  // namespace strainwave::analysis::diagnosis
