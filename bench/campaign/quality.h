// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/campaign/journal.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// Looks at a cycle's results before they are believed: control limits over the cycles (BENCH row 39), stop
/// criteria, and the repeatability that every claimed change is held against (row 40).
class QualityControl {
 public:
  /// Takes up what the journal already holds.
  QualityControl(const schedules::Schedule& schedule, const Journal& journal);

  /// Quantities that lie outside of their control limits, in words; empty: none.
  std::vector<std::string> Outliers(const std::vector<Result>& results) const;

  /// A stop criterion that these results meet, in words.
  std::optional<std::string> StopCriterion(const std::vector<Result>& results) const;

  /// The cycle is stored: its unflagged values become part of the history.
  void Accept(int cycle, const std::vector<Result>& results);

 private:
  const schedules::Schedule& schedule_;
  std::map<std::string, std::vector<double>> history_;  // newest last
  std::optional<double> first_k2_Nm_per_rad_;
};

/// Repeatability of each quantity from the repeats of the preparation, as calibrations
/// "repeatability_QUANTITY": value = standard deviation of one measurement.
std::vector<Calibration> RepeatabilityOf(const std::vector<std::vector<Result>>& repeats);

}  // namespace strainwave::bench
