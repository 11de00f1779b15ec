// SPDX-License-Identifier: Apache-2.0
#include "bench/report/number_text.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "analysis/interval_95.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

// Of "-0.00 ± 0.13".
std::string WithoutSignOfZero(std::string text) {
  if (text.starts_with('-') && text.substr(0, text.find(' ')).find_first_of("123456789") == text.npos)
    text.erase(0, 1);
  return text;
}

}  // namespace

std::string Fixed(double value, int decimals) {
  return WithoutSignOfZero(fmt::format("{:.{}f}", value, decimals));
}

namespace {

std::string FourDigits(double value) {
  if (!std::isfinite(value)) return "–";
  constexpr double kLeastFixed = 1e-3;
  constexpr double kMostFixed = 1e7;
  const double size = std::abs(value);
  if (value == 0.0 || size < kLeastFixed || size >= kMostFixed)
    return WithoutSignOfZero(fmt::format("{:.4g}", value));
  return Fixed(value, std::max(0, 3 - static_cast<int>(std::floor(std::log10(size)))));
}

}  // namespace

std::string FiveDigits(double value) { return std::isfinite(value) ? fmt::format("{:.5g}", value) : "–"; }

std::string With95(const analysis::Estimate& estimate) {
  const double half_width = analysis::HalfWidthOf95(estimate);
  if (!std::isfinite(estimate.value) || !std::isfinite(half_width) || half_width <= 0.0)
    return FourDigits(estimate.value);
  std::string text = EstimateText({estimate.value, half_width}, "");
  text.pop_back();  // the space before a unit
  return WithoutSignOfZero(std::move(text));
}

std::string DurationWords(double time_s) {
  if (!std::isfinite(time_s)) return "–";
  if (time_s >= 3600.0) return fmt::format("{:.4g} h", time_s / 3600.0);
  if (time_s >= 60.0) return fmt::format("{:.3g} min", time_s / 60.0);
  return fmt::format("{:.3g} s", time_s);
}

}  // namespace strainwave::bench
