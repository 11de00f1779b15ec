// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace strainwave::bench {

/// A standard error with two digits, "0.0012" or "160"; a dash where it is not known, which is what zero, not
/// a number and infinity say.
std::string ErrorText(double standard_error);

}  // namespace strainwave::bench
