// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/canopen/bus_troubles.h"

#include <fmt/format.h>

namespace strainwave::bench {
namespace {

const char* Words(CanState state) {
  switch (state) {
    case CanState::kErrorActive:
      return "";
    case CanState::kErrorWarning:
      return "error warning: frames go wrong on the wire (check the cable, both terminations and the bit "
             "rate)";
    case CanState::kErrorPassive:
      return "error passive: many frames go wrong on the wire, or nobody else is on it (check the cable, "
             "both terminations and the bit rate)";
    case CanState::kBusOff:
      return "bus-off: the controller gave up sending (check the cable, both terminations and the bit rate)";
    case CanState::kGone:
      return "the interface is gone (check its plug, and that it is up)";
  }
  return "";
}

}  // namespace

std::vector<std::string> BusTroubles(const DriveBusCounts& counts, const DriveBusCounts& told) {
  std::vector<std::string> troubles;
  if (counts.worst_state > told.worst_state) troubles.emplace_back(Words(counts.worst_state));
  if (counts.malformed > 0 && told.malformed == 0) {
    troubles.push_back(
        fmt::format("{} PDOs of its drives were not as long as their mapping is", counts.malformed));
  }
  return troubles;
}

}  // namespace strainwave::bench
