// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bench/roles/bench_clock.h"
#include "bench/roles/can_bus.h"
#include "protocols/canopen/node_scan.h"

namespace strainwave::bench {

/// Takes a scan to the nodes of a bus, and waits for its end; nothing else may use this end of the bus
/// meanwhile.
/// @param note  gets what kept it from asking, in words; empty otherwise.
std::vector<protocols::canopen::FoundNode> ScanNodes(CanBus& bus, BenchClock& clock,
                                                     protocols::canopen::NodeScan& scan, std::string& note);

}  // namespace strainwave::bench
