// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace strainwave::bench {

/// Bytes that nobody can guess. @throws std::runtime_error where the system has none.
std::vector<unsigned char> RandomBytes(std::size_t count);

/// Two lower-case hexadecimal digits a byte.
std::string HexOf(std::span<const unsigned char> bytes);

}  // namespace strainwave::bench
