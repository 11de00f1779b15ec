// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/quality.h"

#include <array>
#include <cmath>
#include <numbers>

#include <fmt/core.h>

#include "analysis/repeatability.h"
#include "analysis/units.h"
#include "bench/campaign/cycle_results.h"

namespace strainwave::bench {
namespace {

// Quantities that are kept under control limits.
constexpr std::array kControlled{"k1_Nm_per_rad", "k2_Nm_per_rad",      "k3_Nm_per_rad",
                                 "e_max_arcmin",  "lost_motion_arcmin", "hysteresis_arcmin"};
constexpr std::size_t kHistory = 50;
constexpr std::size_t kFewest = 12;
constexpr double kControlWidth = 5.0;

// The unit that a quantity's name ends in.
std::string UnitOf(const std::string& quantity) {
  for (const auto& [ending, unit] :
       {std::pair{"arcmin", "arcmin"}, std::pair{"Nm_per_rad", "Nm/rad"}, std::pair{"percent", "%"},
        std::pair{"degC", "degC"}, std::pair{"m_per_s2", "m/s2"}}) {
    if (quantity.ends_with(ending)) return unit;
  }
  return "";
}

// Nothing is wrong with the value itself; at most it was not taken in the declared thermal state.
bool IsSound(const Result& result) { return result.flag.empty() || result.flag.starts_with(kThermalFlag); }

}  // namespace

QualityControl::QualityControl(const schedules::Schedule& schedule, const Journal& journal)
    : schedule_(schedule) {
  TakeGauge(journal);
  // The same values in the same order as they came, so that a resumed campaign judges as one that was never
  // cut.
  for (const CycleRow& row : journal.Cycles()) {
    if (row.outcome == "complete") Accept(row.cycle, journal.Results(row.cycle, 0));
  }
}

void QualityControl::TakeGauge(const Journal& journal) {
  for (const Calibration& gauge : journal.CalibrationsLike(kRepeatabilityPrefix)) {
    gauge_[gauge.name.substr(kRepeatabilityPrefix.size())] = gauge.value;
  }
}

std::optional<analysis::ControlLimits> QualityControl::LimitsOf(const std::string& quantity) const {
  const auto history = history_.find(quantity);
  if (history == history_.end() || history->second.size() < kFewest) return std::nullopt;
  const auto gauge = gauge_.find(quantity);
  // Three sigmas would call every few hundredth good value an outlier; a measurement taken again costs
  // minutes.
  return analysis::NextValueLimits(
      history->second, {.width = kControlWidth, .sigma_floor = gauge == gauge_.end() ? 0.0 : gauge->second});
}

std::vector<std::string> QualityControl::Outliers(const std::vector<Result>& results) const {
  std::vector<std::string> outliers;
  for (const char* quantity : kControlled) {
    const auto result = FindResult(results, quantity);
    if (!result || !IsSound(*result)) continue;
    const auto limits = LimitsOf(quantity);
    if (!limits || !limits->IsOutlier(result->value)) continue;
    outliers.push_back(fmt::format("{} = {:.5g} is outside of its control limits {:.5g} to {:.5g}", quantity,
                                   result->value, limits->lower, limits->upper));
  }
  return outliers;
}

std::optional<std::string> QualityControl::StopCriterion(const std::vector<Result>& results) const {
  const schedules::StopCriteria& stop = schedule_.stop;
  const auto good = [&](std::string_view quantity) -> std::optional<double> {
    const auto result = FindResult(results, quantity);
    return result && IsSound(*result) ? std::optional(result->value) : std::nullopt;
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
      if (!result.quantity.starts_with("vibration_rms_") ||
          result.value <= *stop.vibration_rms_above_m_per_s2)
        continue;
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
    if (!result || !IsSound(*result)) continue;
    const auto limits = LimitsOf(quantity);
    auto& values = history_[quantity];
    if (limits && limits->IsOutlier(result->value)) values.clear();
    values.push_back(result->value);
    if (values.size() > kHistory) values.erase(values.begin());
  }
  const auto k2 = FindResult(results, "k2_Nm_per_rad");
  if (!first_k2_Nm_per_rad_ && k2 && IsSound(*k2)) first_k2_Nm_per_rad_ = k2->value;
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
    const double widened = gauge.limit_95 / (1.96 * std::numbers::sqrt2);
    const std::string source = fmt::format("{} repeats before the first cycle", values.size());
    const auto name = [&](std::string_view prefix) { return std::string(prefix) + first.quantity; };
    calibrations.push_back({name(kRepeatabilityPrefix), widened,
                            widened / std::sqrt(2.0 * gauge.degrees_of_freedom), UnitOf(first.quantity),
                            source});
    calibrations.push_back(
        {name(kRepeatabilityLimitPrefix), gauge.limit_95, 0.0, UnitOf(first.quantity), source});
  }
  return calibrations;
}

}  // namespace strainwave::bench
