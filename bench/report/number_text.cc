// SPDX-License-Identifier: Apache-2.0
#include "bench/report/number_text.h"

#include <cmath>

#include <fmt/format.h>

#include "analysis/interval_95.h"
#include "bench/plots/script.h"

namespace strainwave::bench {

std::string FiveDigits(double value) { return std::isfinite(value) ? fmt::format("{:.5g}", value) : "–"; }

std::string With95(const analysis::Estimate& estimate) {
  const double half_width = analysis::HalfWidthOf95(estimate);
  if (!std::isfinite(estimate.value) || !std::isfinite(half_width) || half_width <= 0.0)
    return FiveDigits(estimate.value);
  std::string text = EstimateText({estimate.value, half_width}, "");
  text.pop_back();  // the space before a unit
  return text;
}

std::string DurationWords(double time_s) {
  if (!std::isfinite(time_s)) return "–";
  if (time_s >= 3600.0) return fmt::format("{:.4g} h", time_s / 3600.0);
  if (time_s >= 60.0) return fmt::format("{:.3g} min", time_s / 60.0);
  return fmt::format("{:.3g} s", time_s);
}

}  // namespace strainwave::bench
