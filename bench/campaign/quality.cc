// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include <fmt/core.h>

#include "analysis/quantities.h"
#include "analysis/repeatability.h"
#include "analysis/units.h"
#include "bench/campaign/cycle_results.h"
#include "bench/safety/texts_apart.h"

namespace strainwave::bench {
namespace {

namespace quantities = analysis::quantities;
using analysis::Quantity;

// Quantities that are kept under control limits.
constexpr std::array kControlled{quantities::kK1,   quantities::kK2,         quantities::kK3,
                                 quantities::kEMax, quantities::kLostMotion, quantities::kHysteresis};
constexpr std::size_t kHistory = analysis::ControlChartOptions{}.window;
constexpr std::size_t kFewest = 12;
constexpr double kControlWidth = 5.0;
// Looked at in the journal at first; values without a step among them are decided by 2 histories.
constexpr std::size_t kFirstLook = 8 * kHistory;

}  // namespace

QualityControl::QualityControl(const schedules::Schedule& schedule, const Journal& journal)
    : schedule_(schedule) {
  TakeGauge(journal);
  for (const Quantity& quantity : kControlled) {
    const std::string name(quantity.name);
    history_[name] = HistoryIn(journal, name);
  }
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
  for (const Quantity& quantity : kControlled) {
    const auto result = FindResult(results, quantity.name);
    if (!result || !IsSound(*result)) continue;
    const auto history = history_.find(result->quantity);
    if (history == history_.end()) continue;
    const auto limits = LimitsAfter(result->quantity, history->second);
    if (!limits || !limits->IsOutlier(result->value)) continue;
    const int decimals = quantity.unit() == quantities::kK1.unit() ? 0 : 4;
    const std::vector<std::string> texts =
        TextsApart(result->value, {limits->lower, limits->upper}, decimals);
    outliers.push_back(fmt::format("{} = {} is outside of its control limits {} to {}", quantity.name,
                                   texts[0], texts[1], texts[2]));
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
  for (const Quantity& quantity : kControlled) {
    const auto result = FindResult(results, quantity.name);
    if (!result || !IsSound(*result)) continue;
    auto& values = history_[result->quantity];
    if (IsOutlier(result->quantity, values, result->value)) values.clear();
    values.push_back(result->value);
    if (values.size() > kHistory) values.erase(values.begin());
  }
  const auto k2 = FindResult(results, quantities::kK2.name);
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
    const std::string unit(analysis::UnitOf(first.quantity));
    const auto name = [&](std::string_view prefix) { return std::string(prefix) + first.quantity; };
    calibrations.push_back({name(kRepeatabilityPrefix), widened,
                            widened / std::sqrt(2.0 * gauge.degrees_of_freedom), unit, source});
    calibrations.push_back({name(kRepeatabilityLimitPrefix), gauge.limit_95, 0.0, unit, source});
  }
  return calibrations;
}

std::optional<double> FirstK2_Nm_per_rad(const Journal& journal) {
  std::optional<double> first;
  journal.ForEachResult(quantities::kK2.name, [&](const CycleResult& row) {
    if (IsSound(row.result)) first = row.result.value;
    return !first;
  });
  return first;
}

std::optional<StopLimit> StopLimitOf(const schedules::StopCriteria& stop,
                                     std::optional<double> first_k2_Nm_per_rad, std::string_view quantity) {
  if (quantity == quantities::kK2.name && stop.k2_below_share_of_first && first_k2_Nm_per_rad) {
    return StopLimit{*stop.k2_below_share_of_first * *first_k2_Nm_per_rad, true};
  }
  if (quantity == quantities::kEMax.name && stop.e_max_above_rad) {
    return StopLimit{ArcminFromRad(*stop.e_max_above_rad), false};
  }
  if (quantity.starts_with(analysis::kVibrationRms) && stop.vibration_rms_above_m_per_s2) {
    return StopLimit{*stop.vibration_rms_above_m_per_s2, false};
  }
  return std::nullopt;
}

std::vector<StopDistance> StopDistances(const schedules::StopCriteria& stop,
                                        std::optional<double> first_k2_Nm_per_rad,
                                        const std::vector<Result>& results) {
  std::vector<StopDistance> distances;
  for (const Quantity& quantity : {quantities::kK2, quantities::kEMax}) {
    const auto result = FindResult(results, quantity.name);
    if (!result || !IsSound(*result) || std::isnan(result->value)) continue;
    const auto limit = StopLimitOf(stop, first_k2_Nm_per_rad, quantity.name);
    if (!limit) continue;
    distances.push_back({std::string(quantity.symbol), std::string(quantity.unit()), result->value,
                         limit->limit, limit->is_lower});
  }
  for (const Result& result : results) {
    if (!result.quantity.starts_with(analysis::kVibrationRms) || !IsSound(result)) continue;
    const auto limit = StopLimitOf(stop, first_k2_Nm_per_rad, result.quantity);
    if (!limit) continue;
    distances.push_back({result.quantity, std::string(analysis::UnitOf(result.quantity)), result.value,
                         limit->limit, limit->is_lower});
  }
  return distances;
}

}  // namespace strainwave::bench
