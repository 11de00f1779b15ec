// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/control_chart.h"
#include "bench/campaign/journal.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// Looks at a cycle's results before they are believed: control limits over the cycles, stop criteria, and
/// the repeatability that every claimed change is held against (docs/requirements.md R39, R40).
class QualityControl {
 public:
  /// Takes up what the journal already holds.
  QualityControl(const schedules::Schedule& schedule, const Journal& journal);

  /// The repeats of the preparation have been evaluated.
  void TakeGauge(const Journal& journal);

  /// Quantities that lie outside of their control limits, in words; empty: none.
  std::vector<std::string> Outliers(const std::vector<Result>& results) const;

  /// A stop criterion that these results meet, in words.
  std::optional<std::string> StopCriterion(const std::vector<Result>& results) const;

  /// The cycle is stored: its values become part of the history. One that is still outside of the limits
  /// after it was measured again is a step, and the history begins anew with it.
  void Accept(int cycle, const std::vector<Result>& results);

 private:
  std::vector<double> HistoryIn(const Journal& journal, const std::string& quantity) const;
  bool IsOutlier(const std::string& quantity, std::span<const double> history, double value) const;
  std::optional<analysis::ControlLimits> LimitsAfter(const std::string& quantity,
                                                     std::span<const double> history) const;

  const schedules::Schedule& schedule_;
  std::map<std::string, std::vector<double>> history_;  // that decide about the next value, newest last
  std::map<std::string, double> gauge_;                 // repeatability, where it was measured
  std::optional<double> first_k2_Nm_per_rad_;
};

inline constexpr std::string_view kRepeatabilityPrefix = "repeatability_";
inline constexpr std::string_view kRepeatabilityLimitPrefix = "limit_95_";

/// Repeatability of each quantity from the repeats of the preparation, as calibrations:
/// "repeatability_QUANTITY", the standard deviation of one measurement (widened as Student's t asks, so
/// that 1.96 of it hold 95 %), and "limit_95_QUANTITY", by which two of them differ in 5 of 100 cases.
std::vector<Calibration> RepeatabilityOf(const std::vector<std::vector<Result>>& repeats);

/// Of the first cycle whose value is sound; nothing: there is none yet.
std::optional<double> FirstK2_Nm_per_rad(const Journal& journal);

/// A result beyond which the campaign ends.
struct StopLimit {
  double limit{};
  bool is_lower{};  // it ends below, else above
};

/// Of one quantity by its whole name; none where no criterion is about it.
/// @param first_k2_Nm_per_rad  as `FirstK2_Nm_per_rad` has it.
std::optional<StopLimit> StopLimitOf(const schedules::StopCriteria& stop,
                                     std::optional<double> first_k2_Nm_per_rad, std::string_view quantity);

/// How far a cycle is from one of the schedule's stop criteria.
struct StopDistance {
  std::string quantity;
  std::string unit;
  double value{};
  double limit{};
  bool is_lower{};  // the campaign ends below it, else above
};

/// Of those criteria whose quantities the cycle has, in the order in which they are looked at.
/// @param first_k2_Nm_per_rad  as `FirstK2_Nm_per_rad` has it.
std::vector<StopDistance> StopDistances(const schedules::StopCriteria& stop,
                                        std::optional<double> first_k2_Nm_per_rad,
                                        const std::vector<Result>& results);

}  // namespace strainwave::bench
