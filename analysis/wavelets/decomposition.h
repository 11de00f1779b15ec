// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "analysis/wavelets/transform.h"

namespace strainwave::analysis::wavelets {

inline constexpr int kMostLevels = 30;

/// The coefficients of all levels of one channel; level 1 first. Owned by the caller: decomposing another
/// signal of the same length into it allocates nothing.
struct Decomposition {
  std::vector<std::vector<double>> approximations;
  std::vector<std::vector<double>> details;  // empty vectors where they were left out
};

enum class Details { kKeep, kLeaveOut };

/// Decomposes again and again what the level above left as approximation. More levels than the length
/// supports are allowed: the border then reflects more than once.
/// @throws std::invalid_argument if the signal is empty or levels is not in 1 … 30.
void Decompose(std::span<const double> signal, const FilterBank& bank, Border border, int levels,
               Details details, Decomposition& out);

/// The signal from the last approximation and all details.
/// @param samples  length of the signal that was decomposed.
/// @throws std::invalid_argument if a level is missing or lengths do not fit one another.
std::vector<double> Reconstruct(const Decomposition& decomposition, const FilterBank& bank, Border border,
                                std::size_t samples);

}  // namespace strainwave::analysis::wavelets
