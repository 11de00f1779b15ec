// SPDX-License-Identifier: Apache-2.0
#include "bench/utc.h"

#include <chrono>
#include <ctime>

#include <fmt/core.h>

namespace strainwave::bench {

std::string UtcText(std::int64_t milliseconds_since_1970) {
  const std::time_t seconds = milliseconds_since_1970 / 1000;
  std::tm calendar{};
  gmtime_r(&seconds, &calendar);
  return fmt::format("{:04d}-{:02d}-{:02d}T{:02d}:{:02d}:{:02d}.{:03d}Z", calendar.tm_year + 1900,
                     calendar.tm_mon + 1, calendar.tm_mday, calendar.tm_hour, calendar.tm_min,
                     calendar.tm_sec, milliseconds_since_1970 % 1000);
}

std::int64_t UtcMilliseconds() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::string UtcNow() { return UtcText(UtcMilliseconds()); }

}  // namespace strainwave::bench
