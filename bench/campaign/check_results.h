// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bench/campaign/journal.h"
#include "daq/record.h"

namespace strainwave::bench {

/// Whether a record is that of a sensor check (SensorCheckProgram).
bool IsSensorCheck(const daq::Record& record);

/// The quantity of a check in the results: "PHASE_Nm", or "PHASE_arcmin" of the encoders.
std::string CheckQuantity(const daq::Record& record, const std::string& phase);

/// Where the encoders stood against each other in the campaign's first check, for later ones to be held
/// against. Without it a reference check is the first one, and says where they stand.
void SetExpected(daq::Record& record, double expected_arcmin);

/// What a check has found: the torque transducer's reading without torque, what its shunt adds to that, or
/// input angle / ratio − output angle. The flag says in words what is beyond its limit.
Result SensorCheckResult(const daq::Record& record, const std::string& phase);

/// What a technician does about a check that failed.
std::string AdviceAfter(const daq::Record& record);

}  // namespace strainwave::bench
