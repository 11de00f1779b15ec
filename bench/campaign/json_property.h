// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include <nlohmann/json_fwd.hpp>

#include "bench/campaign/journal.h"

namespace strainwave::bench {

/// Reads a property of the journal that the program keeps as JSON. In a folder from elsewhere it may be
/// anything.
/// @param take  gets it; what it throws of nlohmann's exceptions and std::invalid_argument says that it
/// cannot be
///              read, too.
/// @return false where there is none. @throws DatabaseError where it cannot be read.
bool ReadJsonProperty(const Journal& journal, const char* key,
                      const std::function<void(const nlohmann::json&)>& take);

}  // namespace strainwave::bench
