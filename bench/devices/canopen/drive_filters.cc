// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/canopen/drive_filters.h"

namespace strainwave::bench {

using protocols::canopen::PdoFlow;
using protocols::canopen::PdoSetting;

std::vector<CanFilter> FiltersOfDrive(const protocols::canopen::DriveProfile& profile, std::uint8_t node_id) {
  constexpr std::uint32_t kNodeBits = 0x07F;
  constexpr std::uint32_t kAllBits = 0x7FF;
  std::vector<CanFilter> filters = FiltersOfNode(node_id);
  for (const PdoSetting& pdo : PdosOf(profile, node_id)) {
    const bool passes = (pdo.cob_id & kNodeBits) == node_id;
    if (pdo.flow == PdoFlow::kFromDrive && !passes) filters.push_back({pdo.cob_id, kAllBits});
  }
  return filters;
}

}  // namespace strainwave::bench
