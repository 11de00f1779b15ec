// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace strainwave::analysis {

/// What repeated measurements of one thing say about the gauge (docs/requirements.md R40).
struct Repeatability {
  double mean{};
  double repeatability_sd{};    // within a mounting
  double reproducibility_sd{};  // between mountings, 0 where there is one only
  double gauge_sd{};            // both together: of one measurement in one mounting
  double degrees_of_freedom{};  // of repeatability_sd
  /// Two single measurements in one mounting differ by less in 95 of 100 cases: t √2 repeatability_sd.
  double limit_95{};
};

/// One-way random-effects analysis of variance over mountings (or any other groups) of repeats.
///
/// @param groups  at least one with at least two repeats; empty ones and single values are welcome beside it.
/// @throws std::invalid_argument if a value is not finite or no group has two.
/// Source: ISO 5725-2:2019, 7.4 (unequal group sizes), limit as ISO 5725-6, 4.1, with Student's t for few
/// repeats.
Repeatability EstimateRepeatability(std::span<const std::vector<double>> groups);
Repeatability EstimateRepeatability(std::span<const double> repeats);

/// Is a change between the means of two sets of measurements, `count_before` and `count_after` in number,
/// larger than the repeatability explains at 95 %: |change| > t · sd · √(1/before + 1/after)?
/// @throws std::invalid_argument if the change is not finite or a count is zero.
bool IsLargerThanGauge(double change, const Repeatability& gauge, std::size_t count_before = 1,
                       std::size_t count_after = 1);

}  // namespace strainwave::analysis
