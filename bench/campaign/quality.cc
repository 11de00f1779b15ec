// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include <fmt/core.h>

#include "analysis/repeatability.h"
#include "analysis/units.h"
#include "bench/campaign/cycle_results.h"
#include "bench/controller/texts_apart.h"

namespace strainwave::bench {
namespace {

// Quantities that are kept under control limits.
constexpr std::array kControlled{"k1_Nm_per_rad", "k2_Nm_per_rad",      "k3_Nm_per_rad",
                                 "e_max_arcmin",  "lost_motion_arcmin", "hysteresis_arcmin"};
constexpr std::size_t kHistory = analysis::ControlChartOptions{}.window;
constexpr std::size_t kFewest = 12;
constexpr double kControlWidth = 5.0;
// Looked at in the journal at first; values without a step among them are decided by 2 histories.
constexpr std::size_t kFirstLook = 8 * kHistory;

// The unit that a quantity's name ends in.
std::string UnitOf(const std::string& quantity) {
  for (const auto& [ending, unit] :
       {std::pair{"arcmin", "arcmin"}, std::pair{"Nm_per_rad", "Nm/rad"}, std::pair{"percent", "%"},
        std::pair{"degC", "degC"}, std::pair{"m_per_s2", "m/s2"}}) {
    if (quantity.ends_with(ending)) return unit;
  }
  return "";
}

}  // namespace

QualityControl::QualityControl(const schedules::Schedule& schedule, const Journal& journal)
    : schedule_(schedule) {
  TakeGauge(journal);
  for (const char* quantity : kControlled) history_[quantity] = HistoryIn(journal, quantity);
  first_k2_Nm_per_rad_ = FirstK2_Nm_per_rad(journal);
}

// What the values in the order in which they came have left, so that a resumed campaign judges as one that
// was never cut. A history has at most kHistory values: at any place it is one of as many endings of what
// came before. All of them are carried on side by side, and where the same is left of all, what came before
// them does not matter.
std::vector<double> QualityControl::HistoryIn(const Journal& journal, const std::string& quantity) const {
  for (std::size_t look = kFirstLook;; look *= 4) {
    std::vector<double> values;
    const std::vector<Result> newest = journal.NewestResults(quantity, look);
    for (const Result& result : newest) {
      if (IsSound(result)) values.push_back(result.value);
    }
    const bool all = newest.size() < look;
    if (!all && values.size() < kHistory) continue;
    // Lengths that the history may have after the first `next` values.
    std::size_t next = all ? 0 : kHistory;
    std::set<std::size_t> lengths;
    for (std::size_t length = 1; length <= next; ++length) lengths.insert(length);
    if (all) lengths.insert(0);
    for (; next < values.size(); ++next) {
      std::set<std::size_t> after;
      for (const std::size_t length : lengths) {
        const auto history = std::span(values).subspan(next - length, length);
        const bool step = IsOutlier(quantity, history, values[next]);
        after.insert(step ? 1 : std::min(length + 1, kHistory));
      }
      lengths = std::move(after);
    }
    if (lengths.size() == 1)
      return {values.end() - static_cast<std::ptrdiff_t>(*lengths.begin()), values.end()};
  }
}

void QualityControl::TakeGauge(const Journal& journal) {
  for (const Calibration& gauge : journal.CalibrationsLike(kRepeatabilityPrefix)) {
    gauge_[gauge.name.substr(kRepeatabilityPrefix.size())] = gauge.value;
  }
}

std::optional<analysis::ControlLimits> QualityControl::LimitsAfter(const std::string& quantity,
                                                                   std::span<const double> history) const {
  if (history.size() < kFewest) return std::nullopt;
  const auto gauge = gauge_.find(quantity);
  // Three sigmas would call every few hundredth good value an outlier; a measurement taken again costs
  // minutes.
  return analysis::NextValueLimits(
      history, {.width = kControlWidth, .sigma_floor = gauge == gauge_.end() ? 0.0 : gauge->second});
}

bool QualityControl::IsOutlier(const std::string& quantity, std::span<const double> history,
                               double value) const {
  const auto limits = LimitsAfter(quantity, history);
  return limits && limits->IsOutlier(value);
}

std::vector<std::string> QualityControl::Outliers(const std::vector<Result>& results) const {
  std::vector<std::string> outliers;
  for (const char* quantity : kControlled) {
    const auto result = FindResult(results, quantity);
    if (!result || !IsSound(*result)) continue;
    const auto history = history_.find(quantity);
    if (history == history_.end()) continue;
    const auto limits = LimitsAfter(quantity, history->second);
    if (!limits || !limits->IsOutlier(result->value)) continue;
    const int decimals = std::string_view(quantity).ends_with("_Nm_per_rad") ? 0 : 4;
    const std::vector<std::string> texts =
        TextsApart(result->value, {limits->lower, limits->upper}, decimals);
    outliers.push_back(fmt::format("{} = {} is outside of its control limits {} to {}", quantity, texts[0],
                                   texts[1], texts[2]));
  }
  return outliers;
}

std::optional<std::string> QualityControl::StopCriterion(const std::vector<Result>& results) const {
  for (const StopDistance& stop : StopDistances(schedule_.stop, first_k2_Nm_per_rad_, results)) {
    if (stop.is_lower && stop.value < stop.limit) {
      const std::vector<std::string> texts = TextsApart(stop.value, {stop.limit}, 0);
      return fmt::format("{} = {} {} is below {} {}, {:.0f} % of its first value", stop.quantity, texts[0],
                         stop.unit, texts[1], stop.unit, 100.0 * *schedule_.stop.k2_below_share_of_first);
    }
    if (!stop.is_lower && !(stop.value <= stop.limit)) {
      const std::vector<std::string> texts = TextsApart(stop.value, {stop.limit}, 2);
      return fmt::format("{} = {} {} is above {} {}", stop.quantity, texts[0], stop.unit, texts[1],
                         stop.unit);
    }
  }
  return std::nullopt;
}

void QualityControl::Accept(int cycle, const std::vector<Result>& results) {
  if (cycle == 0) return;
  for (const char* quantity : kControlled) {
    const auto result = FindResult(results, quantity);
    if (!result || !IsSound(*result)) continue;
    auto& values = history_[quantity];
    if (IsOutlier(quantity, values, result->value)) values.clear();
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

std::optional<double> FirstK2_Nm_per_rad(const Journal& journal) {
  std::optional<double> first;
  journal.ForEachResult("k2_Nm_per_rad", [&](const CycleResult& row) {
    if (IsSound(row.result)) first = row.result.value;
    return !first;
  });
  return first;
}

std::vector<StopDistance> StopDistances(const schedules::StopCriteria& stop,
                                        std::optional<double> first_k2_Nm_per_rad,
                                        const std::vector<Result>& results) {
  std::vector<StopDistance> distances;
  const auto good = [&](std::string_view quantity) -> std::optional<double> {
    const auto result = FindResult(results, quantity);
    const bool is_known = result && IsSound(*result) && !std::isnan(result->value);
    return is_known ? std::optional(result->value) : std::nullopt;
  };
  if (const auto k2 = good("k2_Nm_per_rad"); k2 && stop.k2_below_share_of_first && first_k2_Nm_per_rad) {
    distances.push_back({"K2", "Nm/rad", *k2, *stop.k2_below_share_of_first * *first_k2_Nm_per_rad, true});
  }
  if (const auto e_max = good("e_max_arcmin"); e_max && stop.e_max_above_rad) {
    distances.push_back({"e_max", "arcmin", *e_max, ArcminFromRad(*stop.e_max_above_rad), false});
  }
  if (!stop.vibration_rms_above_m_per_s2) return distances;
  for (const Result& result : results) {
    if (!result.quantity.starts_with("vibration_rms_")) continue;
    distances.push_back({result.quantity, "m/s2", result.value, *stop.vibration_rms_above_m_per_s2, false});
  }
  return distances;
}

}  // namespace strainwave::bench
