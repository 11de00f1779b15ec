// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace strainwave::bench {

/// Lower-case hexadecimal SHA-256.
std::string Sha256(std::string_view text);
/// The same of a whole file, which need not fit into memory. @throws std::system_error.
std::string Sha256OfFile(const std::filesystem::path& file);

}  // namespace strainwave::bench
