// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/error_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace strainwave::bench {

std::string ErrorText(double standard_error) {
  if (!std::isfinite(standard_error) || standard_error <= 0.0) return "–";
  constexpr double kSmallest = 1e-6;
  if (standard_error < kSmallest) return fmt::format("{:.2g}", standard_error);
  const int decimals = std::max(0, 1 - static_cast<int>(std::floor(std::log10(standard_error))));
  return fmt::format("{:.{}f}", standard_error, decimals);
}

}  // namespace strainwave::bench
