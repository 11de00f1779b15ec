// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace strainwave::analysis {

/// The share of a sweep's angle that each sample stands for, so that ∑ wᵢ eᵢ is the mean of e over the angle
/// by the trapezoid rule, wherever the sweep was slow or stood still. The samples of a revolution close: what
/// the last one lacks of it lies between it and the first. A sweep that lacks more than its steps counts as
/// far as it goes.
/// @param angle_rad  at least 2 samples of one revolution at most, in the order of the sweep; noise may make
///   neighbours turn back.
/// @throws std::invalid_argument for fewer samples, or where the last angle is the first.
std::vector<double> AngleWeights(std::span<const double> angle_rad);

/// The angle that the weights share out: the way of the sweep, and what the last sample lacks of a revolution
/// that closes. Signed as the sweep turns. Errors as above.
double WeightedAngle(std::span<const double> angle_rad);

/// The step of a sweep where it moves: half of its way is made in steps of this size and more. 0 for one that
/// does not move. However long it stands still or is slow, this is what its angles are apart.
double UsualStep(std::span<const double> angle_rad);

}  // namespace strainwave::analysis
