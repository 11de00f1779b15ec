// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "bench/configuration/bench_description.h"
#include "schedules/reader/findings.h"

namespace strainwave::bench {

/// A bench or plant file that cannot be used.
class BenchFileError : public schedules::FileError {
 public:
  using FileError::FileError;
};

/// Reads a bench file, and the plant file that it may name, relative to its own folder.
/// @throws BenchFileError with every error of the file, if there is one.
BenchDescription ReadBenchFile(const std::filesystem::path& path);

/// The same for a text, which messages call `file_name`; a plant file is looked for in `folder`.
BenchDescription ParseBenchFile(const std::string& text, std::string_view file_name,
                                const std::filesystem::path& folder = {});

/// Reads the terms of a plant from a file of their own (`plant: 1`, then `terms:`); what `diagnose` has
/// written there beside them is left alone.
/// @throws BenchFileError with every error of the file, if there is one.
std::vector<TermDescription> ReadPlantFile(const std::filesystem::path& path);

}  // namespace strainwave::bench
