// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "daq/record.h"

namespace strainwave::daq {

/// For a message about a value that is none of them.
inline constexpr std::string_view kDirectionWords = "cw or ccw, forward or backward, 1 or -1";

/// cw, forward, positive, 1; ccw, backward, reverse, negative, -1: in capitals or not, blanks around them
/// left out, numbers in any writing. Nothing for another text.
std::optional<Direction> DirectionOf(std::string_view text);
std::optional<Direction> DirectionOf(double number);

}  // namespace strainwave::daq
