// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "bench/campaign/check_trends.h"

namespace strainwave::bench {

/// A line for every sensor check: last result, limit, trend, and when that meets the limit.
std::string CheckText(std::span<const CheckHistory> histories);
/// The same as a list of objects.
nlohmann::json CheckJson(std::span<const CheckHistory> histories);

}  // namespace strainwave::bench
