// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "bench/campaign/journal.h"
#include "daq/record.h"

namespace strainwave::bench {

/// Of the measurement rotation's slow channels: the efficiency, or of its breakaway, which has no output
/// torque, the starting torque.
std::vector<Result> RotationResults(const daq::Record& record, double ratio);

/// Of its vibration: RMS of each accelerometer about its mean, flagged where the sensor was dead or at the
/// end of its range for a part of the record.
std::vector<Result> VibrationResults(const daq::Record& record);

}  // namespace strainwave::bench
