// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace strainwave::analysis::diagnosis {

/// Indices, ascending, of single samples that stand off the four before them and the four after them (fewer
/// at the ends) to the same side, or off the cubic through two on either side, while those next to them do
/// not: nothing physical lasts one sample. Two side by side as well, where there are so many of them that
/// some meet by chance.
/// @param resolution  step of a quantised signal: flicker by one or two of them is none
std::vector<std::size_t> FindLoneSamples(std::span<const double> signal, double resolution = 0.0);

}  // namespace strainwave::analysis::diagnosis
