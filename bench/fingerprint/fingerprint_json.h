// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "bench/fingerprint/classify_file.h"
#include "bench/fingerprint/train_fingerprints.h"

namespace strainwave::bench {

/// What `fingerprint train --json` prints and the model keeps
/// (docs/contract.md#health-faults-and-fingerprints).
nlohmann::ordered_json TrainingJsonOf(const FingerprintData& data, const FingerprintJob& job,
                                      const FingerprintOutcome& outcome);

/// `{"file", "probability", "class", "attribution": {"joint1": …}, …}`.
nlohmann::ordered_json JsonOf(const FileVerdict& verdict, const FingerprintModel& model);

}  // namespace strainwave::bench
