// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace strainwave::bench {

/// Times real time: "max" is infinity, "real" 1. @throws BenchError for what is neither nor a number above
/// 0.
double ParsePace(const std::string& text);

}  // namespace strainwave::bench
