// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "analysis/diagnosis/records.h"

namespace strainwave::analysis::diagnosis {

/// What is known of an axis without any named effect (docs/effects.md E8); in SI, linear axes in N and m.
struct AxisNumbers {
  double inertia{};
  double viscous{};
  double coulomb{};
  double offset{};  // torque of a constant load
};

/// The record that such an axis would give on the path that was measured: the smoothed path is the reference
/// of a cascade of position and velocity loops with feed-forward of acceleration; the friction sticks over a
/// presliding distance, as a bristle of one stiffness does
/// ([Dahl](docs/sources.md#dahl-1968)); position, velocity and torque are sampled at the record's own
/// instants, with white noise as the record's own columns have it and its position's steps. What a record
/// does not tell is drawn: noise, bandwidth of the position loop (5 to 30 Hz), presliding distance (10⁻⁵ to
/// 3·10⁻⁴ of the travel).
/// The ranges of the two are rules of thumb for servo axes, not measured.
/// @param draw  another number, another record; the same gives the same.
/// @returns nothing where no such axis follows the path: inertia or friction below zero, an unstable loop.
std::optional<MotionData> SimulateAxis(const MotionData& measured, const AxisNumbers& numbers,
                                       std::uint64_t draw);

}  // namespace strainwave::analysis::diagnosis
