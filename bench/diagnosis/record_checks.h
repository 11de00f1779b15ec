// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bench/campaign/campaign_error.h"
#include "daq/record.h"

namespace strainwave::bench {

/// What makes a valid record unfit to be diagnosed, or doubtful: a ratio or a unit that the angles
/// contradict, directions that contradict them, time stamps that repeat. What only a kind's own model can see
/// (a torque that saturates, a record too short) its study says.
/// @return doubts, as sentences.
/// @throws CampaignError with `FILE: error: WHAT (what was expected)`.
std::vector<std::string> CheckForDiagnosis(const daq::Record& record);

/// `FILE: error: WHAT`, with the group of an HDF5 file: what a record is refused with.
CampaignError RecordRefusal(const daq::Record& record, const std::string& what);

}  // namespace strainwave::bench
