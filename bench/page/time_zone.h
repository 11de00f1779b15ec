// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace strainwave::bench {

/// Name of this machine's time zone as browsers know it ("Europe/Berlin"): of the variable TZ, else of the
/// file that /etc/localtime leads to; "UTC" where neither says one.
std::string TimeZone();

/// The name in such a variable or path; empty: none.
std::string TimeZoneIn(const std::string& text);

}  // namespace strainwave::bench
