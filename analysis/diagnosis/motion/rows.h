// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "analysis/diagnosis/motion/bandwidth.h"
#include "analysis/diagnosis/motion/grid.h"

namespace strainwave::analysis::diagnosis {

/// Where the points of a segment lie in its even samples.
struct PointLayout {
  std::size_t margin{};  // samples next to either end, of which less is known
  std::size_t stride{};  // samples a point

  std::size_t SampleOf(std::size_t point_in_segment) const { return point_in_segment * stride; }
};

/// Chooses the rows of a grid that has its points: evenly, but for what MotionGrid leaves out. The time of a
/// reversal is known no better than velocity noise and smoothing let it; rows in which Coulomb friction makes
/// more of that than noise are left out, too, unless reversals are so frequent that little would be left.
/// @param bandwidth  its Coulomb friction, about, is compared with `grid.noise_floor`
/// @param reversal_smoothing_error  of the friction at each point, where nobody knows over which speed it
///   turns round
void ChooseMotionRows(const MotionSamples& samples, std::span<const PointLayout> layouts,
                      const MotionBandwidth& bandwidth, double expected_delay_s,
                      std::span<const double> reversal_smoothing_error, MotionGrid& grid);

}  // namespace strainwave::analysis::diagnosis
