// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "analysis/torsional_stiffness.h"
#include "bench/campaign/record_context.h"
#include "daq/record.h"

namespace strainwave::bench {

/// What `recompute` says of one record file: docs/contract.md#recompute, and beside it standard errors, the
/// order spectrum, the other two stiffness methods, the checks and the warnings.
/// @param context  what is known of the record's bench: taken off, and its uncertainty is in the errors.
/// @throws BenchError when the record is of a kind that has nothing to recompute.
nlohmann::json RecordJson(const daq::Record& record, analysis::StiffnessMethod method,
                          const RecordContext& context);

/// The same as text for people.
std::string RecordText(const nlohmann::json& report, const std::string& source);

}  // namespace strainwave::bench
