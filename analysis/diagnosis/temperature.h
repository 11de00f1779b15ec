// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace strainwave::analysis::diagnosis {

/// A temperature without the sensor's noise, which would make less of whatever follows it, and white noise of
/// what is left beside it: temperatures change slowly, so this is a parabola through a tenth of the record
/// about each sample.
std::vector<double> SlowTemperature(std::span<const double> temperature_degC);

}  // namespace strainwave::analysis::diagnosis
