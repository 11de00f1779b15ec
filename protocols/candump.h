// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/can_frame.h"

namespace strainwave::protocols {

/// A frame as it stands in a log of can-utils.
struct LoggedFrame {
  std::chrono::microseconds time{};  // since 1970, as the log has it
  std::string interface;
  CanFrame frame;

  bool operator==(const LoggedFrame&) const = default;
};

/// The frame as `candump -L` prints it and `canplayer` reads it, without the end of line:
/// `(1436509052.249713) vcan0 123#DEADBEEF`. A remote frame has `R` and its length for data; an extended id
/// has eight digits; an error frame is one of eight digits with bit 29 set.
std::string CandumpLine(const LoggedFrame& logged);

/// Reads a log of classical frames; empty lines are passed over.
/// @throws std::runtime_error with every finding, one a line,
///   `FILE:LINE:COLUMN: error: WHAT (what was expected)`; messages call the file `file_name`.
std::vector<LoggedFrame> ParseCandump(std::string_view text, std::string_view file_name);

}  // namespace strainwave::protocols
