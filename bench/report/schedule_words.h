// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// What a phase does, in a sentence with the units of the field: "runs at 40 Nm …".
std::string PhaseWords(const schedules::Phase& phase);

}  // namespace strainwave::bench
