// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/run_begun.h"

#include <sstream>

#include <fmt/core.h>

namespace strainwave::bench {

std::string TextOf(const RunBegun& begun) {
  return fmt::format("{} {:.3f} {} {} {}", begun.utc_ms, begun.time_s, begun.process, begun.since_boot_ms,
                     begun.boot);
}

std::optional<RunBegun> ParseRunBegun(const std::string& text) {
  std::istringstream words(text);
  RunBegun begun;
  if (!(words >> begun.utc_ms >> begun.time_s)) return std::nullopt;
  words >> begun.process >> begun.since_boot_ms >> begun.boot;
  return begun;
}

}  // namespace strainwave::bench
