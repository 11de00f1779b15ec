// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daq/record.h"

namespace strainwave::bench {

/// What makes a valid record of kind transmission_error unfit, or questionable: a ratio or a unit that the
/// angles contradict, directions that contradict them. Warnings become notes of the record.
/// @throws BenchError with `FILE: error: WHAT (what was expected)`.
void CheckSweep(daq::Record& record);

}  // namespace strainwave::bench
