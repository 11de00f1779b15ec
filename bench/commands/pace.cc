// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/pace.h"

#include <cstdlib>
#include <limits>

#include <fmt/core.h>

#include "bench/errors/bench_error.h"

namespace strainwave::bench {

double ParsePace(const std::string& text) {
  if (text == "max") return std::numeric_limits<double>::infinity();
  if (text == "real") return 1.0;
  char* end = nullptr;
  const double pace = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || *end != '\0' || !(pace > 0.0)) {
    throw BenchError(
        ExitCode::kWrongInput,
        fmt::format("--pace {}: error: not a pace (expected max, real, or a number above 0)", text));
  }
  return pace;
}

}  // namespace strainwave::bench
