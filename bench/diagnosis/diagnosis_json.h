// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "bench/diagnosis/diagnosis_report.h"

namespace strainwave::bench {

/// A diagnosis as `diagnose --json` prints it: docs/contract.md#diagnose, and beside it the records, every
/// candidate, corrections, quantities, notes and warnings. Field units; what is called a number there is a
/// finite one, other numbers that are not known are null.
nlohmann::ordered_json DiagnosisJson(const DiagnosisReport& report);

}  // namespace strainwave::bench
