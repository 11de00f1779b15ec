// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "analysis/transmission_error.h"

namespace strainwave::bench {

/// "16020 ± 69": half width of the 95 % interval with two digits, the value to the same place. Without a
/// standard error four digits of the value, and all before the point; "–" for one that is not finite. A value
/// that rounds to zero has no sign.
std::string With95(const analysis::Estimate& estimate);

/// A value with so many decimals; none of "-0".
std::string Fixed(double value, int decimals);

/// Five digits; "–" where it is not finite.
std::string FiveDigits(double value);

/// "1 min", "72 h", "2.5 s".
std::string DurationWords(double time_s);

}  // namespace strainwave::bench
