// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "bench/fingerprint/train_fingerprints.h"

namespace strainwave::bench {

/// Writes the folder of a model: `numbers.h5`, then `fingerprint.json`, which says what the other is and what
/// itself was when written; each appears whole. @throws DataFileError.
void WriteFingerprintModel(const std::filesystem::path& folder, const FingerprintModel& model);

/// @throws BenchError (exit code 2) if a file is missing, changed since it was written, or does not fit the
/// other.
FingerprintModel ReadFingerprintModel(const std::filesystem::path& folder);

}  // namespace strainwave::bench
