// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/fingerprint/classify_file.h"
#include "bench/fingerprint/train_fingerprints.h"

namespace strainwave::bench {

/// What training came to, for people, on standard output.
void PrintFingerprintTraining(const FingerprintData& data, const FingerprintOutcome& outcome);
void PrintVerdict(const FileVerdict& verdict, const FingerprintModel& model);

/// The files that were named, and of folders the .csv, .h5 and .hdf5 files in them but labels.csv, by name.
/// @throws BenchError for a folder without any.
std::vector<std::filesystem::path> JointRecordPaths(const std::vector<std::string>& paths);

}  // namespace strainwave::bench
