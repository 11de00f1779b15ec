// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "schedules/reader/schedule.h"
#include "schedules/reader/yaml_map.h"

namespace strainwave::schedules {

/// Reads a list of phases; `kind` decides which keys each may have, and gives the name of one without. A
/// phase of unknown kind becomes a stand-in of no meaning, beside a finding.
std::vector<Phase> ReadPhases(std::vector<YamlMap> maps);

}  // namespace strainwave::schedules
