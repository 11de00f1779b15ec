// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/quality.h"

#include <array>
#include <cmath>

#include <fmt/core.h>

#include "analysis/control_chart.h"
#include "analysis/repeatability.h"
#include "analysis/units.h"
#include "bench/campaign/cycle_results.h"

namespace strainwave::bench {
namespace {

// Quantities that are kept under control limits.
constexpr std::array kControlled{"k1_Nm_per_rad", "k2_Nm_per_rad", "k3_Nm_per_rad", "e_max_arcmin",
                                 "lost_motion_arcmin", "hysteresis_arcmin"};
constexpr std::size_t kHistory = 50;
constexpr std::size_t kFewest = 12;
constexpr double kControlWidth = 5.0;

std::string UnitOf(const std::string& quantity) { return quantity.ends_with("arcmin") ? "arcmin" : "Nm/rad"; }

}  // namespace

QualityControl::QualityControl(const schedules::Schedule& schedule, const Journal& journal) : schedule_(schedule) {
  for (const char* quantity : kControlled) {
    for (const auto& [cycle, value] : journal.Series(quantity)) history_[quantity].push_back(value);
    auto& values = history_[quantity];
    if (values.size() > kHistory) values.erase(values.begin(), values.end() - kHistory);
  }
  if (const auto k2 = journal.Series("k2_Nm_per_rad"); !k2.empty()) first_k2_Nm_per_rad_ = k2.front().second;
}

std::vector<std::string> QualityControl::Outliers(const std::vector<Result>& results) const {
  std::vector<std::string> outliers;
  for (const char* quantity : kControlled) {
    const auto result = FindResult(results, quantity);
    const auto history = history_.find(quantity);
    if (!result || !result->flag.empty() || history == history_.end()) continue;
    // Three moving-range sigmas give a false alarm every few hundred cycles and quantity; a measurement taken
    // again costs minutes, so the limits are wide.
    const auto limits = analysis::NextValueLimits(history->second, {.width = kControlWidth});
    if (history->second.size() < kFewest || !limits || !limits->IsOutlier(result->value)) continue;
    outliers.push_back(fmt::format("{} = {:.5g} is outside of its control limits {:.5g} to {:.5g}", quantity,
                                   result->value, limits->lower, limits->upper));
  }
  return outliers;
}

std::optional<std::string> QualityControl::StopCriterion(const std::vector<Result>& results) const {
  const schedules::StopCriteria& stop = schedule_.stop;
  const auto good = [&](std::string_view quantity) -> std::optional<double> {
    const auto result = FindResult(results, quantity);
    return result && result->flag.empty() ? std::optional(result->value) : std::nullopt;
  };
  if (const auto k2 = good("k2_Nm_per_rad"); k2 && stop.k2_below_share_of_first && first_k2_Nm_per_rad_) {
    const double limit = *stop.k2_below_share_of_first * *first_k2_Nm_per_rad_;
    if (*k2 < limit) {
      return fmt::format("K2 = {:.0f} Nm/rad is below {:.0f} Nm/rad, {:.0f} % of its first value", *k2, limit,
                         100.0 * *stop.k2_below_share_of_first);
    }
  }
  if (const auto e_max = good("e_max_arcmin"); e_max && stop.e_max_above_rad) {
    const double limit = ArcminFromRad(*stop.e_max_above_rad);
    if (*e_max > limit) return fmt::format("e_max = {:.2f} arcmin is above {:.2f} arcmin", *e_max, limit);
  }
  if (stop.vibration_rms_above_m_per_s2) {
    for (const Result& result : results) {
      if (!result.quantity.starts_with("vibration_rms_") || result.value <= *stop.vibration_rms_above_m_per_s2) continue;
      return fmt::format("{} = {:.2f} m/s2 is above {:.2f} m/s2", result.quantity, result.value,
                         *stop.vibration_rms_above_m_per_s2);
    }
  }
  return std::nullopt;
}

void QualityControl::Accept(int cycle, const std::vector<Result>& results) {
  if (cycle == 0) return;
  for (const char* quantity : kControlled) {
    const auto result = FindResult(results, quantity);
    if (!result || !result->flag.empty()) continue;
    auto& values = history_[quantity];
    values.push_back(result->value);
    if (values.size() > kHistory) values.erase(values.begin());
  }
  const auto k2 = FindResult(results, "k2_Nm_per_rad");
  if (!first_k2_Nm_per_rad_ && k2 && k2->flag.empty()) first_k2_Nm_per_rad_ = k2->value;
}

std::vector<Calibration> RepeatabilityOf(const std::vector<std::vector<Result>>& repeats) {
  std::vector<Calibration> calibrations;
  if (repeats.size() < 2) return calibrations;
  for (const Result& first : repeats.front()) {
    std::vector<double> values;
    for (const auto& repeat : repeats) {
      const auto result = FindResult(repeat, first.quantity);
      if (result && std::isfinite(result->value)) values.push_back(result->value);
    }
    if (values.size() < 2) continue;
    const auto gauge = analysis::EstimateRepeatability(values);
    const std::string source = fmt::format("{} repeats before the first cycle", values.size());
    calibrations.push_back({"repeatability_" + first.quantity, gauge.repeatability_sd,
                            gauge.repeatability_sd / std::sqrt(2.0 * gauge.degrees_of_freedom), UnitOf(first.quantity),
                            source});
    calibrations.push_back({"repeatability_limit_" + first.quantity, gauge.limit_95, 0.0, UnitOf(first.quantity), source});
  }
  return calibrations;
}

}  // namespace strainwave::bench
