// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

/// Files that say of themselves what they were: their last key, `sha256`, is that of all that stands before
/// it.
namespace strainwave::bench {

void Seal(nlohmann::ordered_json& json);

/// @throws BenchError if the file has changed since it was sealed; nlohmann's exception if it has no seal.
void RequireSeal(const std::filesystem::path& file, nlohmann::ordered_json json);

/// The bytes of a file.
/// @throws BenchError if it cannot be read, naming what was expected, or has more than 1 GiB.
std::string ReadBounded(const std::filesystem::path& file, const std::string& expected);

/// The bytes of a file that a sealed description lists: `entry` has its `file` and `sha256`.
/// @throws BenchError as ReadBounded, and if it has changed since; nlohmann's exception for another entry.
std::string ReadListed(const std::filesystem::path& folder, const nlohmann::ordered_json& entry,
                       const std::string& expected);

}  // namespace strainwave::bench
