// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "bench/prediction/operating_envelope.h"
#include "daq/record.h"

namespace strainwave::bench {

/// What a vibration record tells under a name of `OperatingNames`: a value a row, one in all from the
/// metadata, or none.
std::vector<double> OperatingValuesOf(const daq::Record& record, std::string_view name);

/// Of a vibration record, over its length.
OperatingPoint OperatingPointOf(const daq::Record& record);

/// Tells a vibration record, in its metadata, the torque at the output and the temperature of the gear that
/// were logged beside it; what it tells itself stays.
/// @param rotation  of kind motion, from the same measurement rotation.
void AddOperatingPoint(daq::Record& vibration, const daq::Record& rotation);

}  // namespace strainwave::bench
