// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace strainwave::bench {

/// What people have written, for a terminal: control characters, those that turn the direction of writing,
/// and bytes that are no UTF-8 appear as "\n", "\t", "\x1b", "\u202e". All else is as it was.
std::string Escaped(std::string_view text);

}  // namespace strainwave::bench
