// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace strainwave::bench {

/// "2026-03-01T12:00:00.250Z", from the world's clock; for people, never for intervals.
std::string UtcNow();
std::string UtcText(std::int64_t milliseconds_since_1970);
std::int64_t UtcMilliseconds();

}  // namespace strainwave::bench
