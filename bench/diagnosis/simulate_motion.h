// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "analysis/diagnosis/study.h"
#include "daq/record.h"

namespace strainwave::bench {

/// The drive's torque (force) row by row under the motion of a record. A study of motions sees the torque
/// through a filter, at fewer rows; what of the model is a formula of position, speed and acceleration is
/// therefore computed here for every row, and the rest is the study's, between its rows by straight lines.
std::vector<double> SimulateMotion(const daq::Record& like, const analysis::diagnosis::Study& study,
                                   std::span<const analysis::diagnosis::ParameterValue> nominal,
                                   std::span<const analysis::diagnosis::Study::NamedCause> causes);

}  // namespace strainwave::bench
