// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analysis/diagnosis/hysteresis/effects.h"

namespace strainwave::analysis::diagnosis {

/// An effect drawn at random beside a fit, which it is no part of: numbers that are no amounts uniform in
/// their ranges, as far as the rule's ranges hold them; amounts in one direction. Both outlive what is
/// returned.
/// @returns nothing where no draw of many has the rule's amount
std::optional<DrawnEffect> DrawLoopEffect(const LoopRecords& records, const LoopEffects& effects,
                                          std::size_t cause, const ModelFit& beside, std::uint64_t draw);

/// The records with other output angles, rad, one record after the other.
/// @throws std::invalid_argument for another number of samples
std::vector<HysteresisData> WithAngles(std::span<const HysteresisData> records,
                                       std::span<const double> output_angle_rad);

}  // namespace strainwave::analysis::diagnosis
