// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "analysis/transmission_error.h"

namespace strainwave::bench {

/// "16020 ± 69": half width of the 95 % interval with two digits, the value to the same place. Without a
/// standard error five digits of the value; "–" for one that is not finite.
std::string With95(const analysis::Estimate& estimate);

/// Five digits; "–" where it is not finite.
std::string FiveDigits(double value);

/// "1 min", "72 h", "2.5 s".
std::string DurationWords(double time_s);

}  // namespace strainwave::bench
