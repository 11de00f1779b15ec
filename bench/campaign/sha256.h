// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace strainwave::bench {

/// Lower-case hexadecimal SHA-256.
std::string Sha256(std::string_view text);

}  // namespace strainwave::bench
