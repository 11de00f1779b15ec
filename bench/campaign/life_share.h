// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "analysis/bearing_life.h"
#include "schedules/reader/plan.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

analysis::GearRating RatingOf(const schedules::Specimen& specimen);

/// Share of the wave-generator bearing's L10 life that the load blocks use up (cube law, Miner sum).
double LifeShare(const schedules::Specimen& specimen, const std::vector<schedules::LoadBlock>& blocks);

}  // namespace strainwave::bench
