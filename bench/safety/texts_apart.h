// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace strainwave::bench {

/// A value and what it is held against, with as many decimals, `decimals` at least, as it takes that the
/// value reads as another number than each of them: never "25.0 is above 25.0".
std::vector<std::string> TextsApart(double value, const std::vector<double>& others, int decimals);

}  // namespace strainwave::bench
