// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "bench/faults/fault_model.h"
#include "bench/faults/train_faults.h"

namespace strainwave::bench {

/// What `faults train --json` prints: docs/contract.md#health-faults-and-fingerprints, and more.
nlohmann::ordered_json FaultReport(const std::filesystem::path& folder, const FaultRecords& records,
                                   const FaultOutcome& outcome);

/// One object of what `faults classify --json` prints.
nlohmann::ordered_json VerdictJson(const FaultModel& model, const FaultVerdict& verdict);

}  // namespace strainwave::bench
