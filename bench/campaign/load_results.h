// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "bench/campaign/journal.h"
#include "daq/cycle_file.h"

namespace strainwave::bench {

/// Of each load run of a cycle, all of its attempts together: `PHASE_credited_s`, time in which transducer
/// and encoder were within tolerance of the load asked for, and `PHASE_equivalent_s`, time at that load which
/// would wear the wave-generator bearing as the load measured in it did (Miner;
/// bench/controller/load_run_program.h).
std::vector<Result> LoadResults(std::span<const daq::NamedRecord> records);

}  // namespace strainwave::bench
