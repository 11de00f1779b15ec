// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/fleet/plan.h"

namespace strainwave::bench {

/// What a command made of one record.
struct FleetResult {
  int exit_code{};                // 0; 1: a check of it failed; 2: the record is refused
  nlohmann::ordered_json report;  // null where it is refused
  std::string words;              // of a refusal
};

/// @return nothing where there is none, or it is not whole: then it is computed again.
std::optional<FleetResult> ReadResult(const PlanFolder& folder, const PlannedInput& input);

/// Keeps a result whole or not at all, however many write it at once; a failure of it is taken away.
/// @throws DataFileError.
void KeepResult(const PlanFolder& folder, const PlannedInput& input, const FleetResult& result);

/// Why there was no result the last time: the machine's trouble, or a changed record. Another try may do.
void KeepFailure(const PlanFolder& folder, const PlannedInput& input, const std::string& words);
std::optional<std::string> ReadFailure(const PlanFolder& folder, const PlannedInput& input);

}  // namespace strainwave::bench
