// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "schedules/reader/quantity.h"

namespace strainwave::schedules {

/// How far a value of a file may go: beyond lies a slip of the pen, or what nobody should want.
struct QuantityBound {
  /// The key, and as much of the path before it as tells it from others: "suspend.bad_sensor", "log_rate".
  std::string_view path;
  std::optional<Dimension> dimension;  // none: a plain number
  std::string_view least;              // as a file would have it; empty: any
  std::string_view most;               // the same; of a value that may be negative in either direction
  std::string_view reason;             // continues "expected no more, since …"
};

/// What is wrong with a value that lies beyond its bound: "is above 1 min (expected no more, since …)"; empty
/// where it does not. That of a value that `bounds` does not have is the widest that a bench can have of its
/// dimension.
/// @param path  in the file: "phases[2].duration".
std::string BeyondBound(std::span<const QuantityBound> bounds, std::string_view path,
                        std::optional<Dimension> dimension, double value);

}  // namespace strainwave::schedules
