// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "bench/campaign/cycle_context.h"
#include "bench/campaign/folder.h"
#include "bench/campaign/journal.h"
#include "daq/record.h"

namespace strainwave::bench {

/// What is drawn of a cycle.
struct CycleCurves {
  std::vector<NamedRecord> records;  // the analysis points into these
  CycleAnalysis analysis;            // errors of the transmission error as the tables give them
  std::vector<double> twist_rad;     // of the loop at the first lock angle; empty without one
  std::vector<double> torque_Nm;
};

/// @throws as ReadCycleRecords.
CycleCurves ReadCycleCurves(const CampaignFolder& folder, const Journal& journal, int cycle,
                            const CycleContext& context);

/// The gear's own twist: what the bench adds in series is taken off, as it is for the fit.
std::vector<double> TwistOf(const daq::Record& hysteresis, double compliance_rad_per_Nm);

/// The errors of e_max as the tables give them.
void AddUncertainty(const BenchCorrections& corrections, analysis::TransmissionError& error);

}  // namespace strainwave::bench
