// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "analysis/networks/design.h"

namespace strainwave::bench {

/// `{"input": [channels, length], "layers": [{"dense": 500, "activation": "sigmoid"}, …]}`.
nlohmann::ordered_json JsonOf(const analysis::networks::Design& design);

/// @throws nlohmann::json::exception for another structure; std::invalid_argument for an unknown layer or
///   activation.
analysis::networks::Design DesignFrom(const nlohmann::ordered_json& json);

}  // namespace strainwave::bench
