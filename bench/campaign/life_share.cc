// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/life_share.h"

namespace strainwave::bench {

analysis::GearRating RatingOf(const schedules::Specimen& specimen) {
  return {specimen.rated_torque_Nm, specimen.rated_speed_rad_per_s, specimen.bearing_l10_s,
          specimen.ratcheting_torque_Nm, specimen.buckling_torque_Nm};
}

double LifeShare(const schedules::Specimen& specimen, const std::vector<schedules::LoadBlock>& blocks) {
  std::vector<analysis::LoadBlock> loads;
  for (const auto& block : blocks) {
    loads.push_back({block.output_torque_Nm, block.mean_input_speed_rad_per_s, block.duration_s});
  }
  return analysis::LifeConsumed(RatingOf(specimen), loads);
}

}  // namespace strainwave::bench
