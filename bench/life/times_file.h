// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/reliability/lifetimes.h"

namespace strainwave::bench {

/// A segment of a unit's test, up to `end`.
struct LoadStep {
  double end{};  // of the unit's own time
  double torque_Nm{};
  double speed_rpm{};
};

/// One unit of a table of times, or several that have the same.
struct TimesRow {
  int line{};  // of the row that says how it ended
  std::string name;
  analysis::reliability::Lifetime life;
  int mode{-1};                 // of its failure, into `modes`
  std::vector<LoadStep> steps;  // none without a column of loads
};

/// A table of times to failure and suspension (docs/life.md#a-table-of-times).
struct TimesTable {
  std::filesystem::path path;
  std::string unit;  // of time: "h" of the column time_h
  std::vector<TimesRow> rows;
  std::vector<std::string> modes;
  bool has_torque{};
  bool has_speed{};
  std::vector<std::string> warnings;

  std::vector<analysis::reliability::Lifetime> lifetimes() const;
};

/// @throws BenchError (exit code 2) with everything that is wrong, a line each:
/// "FILE:LINE:COLUMN: error: WHAT (expected EXPECTED)".
TimesTable ReadTimes(const std::filesystem::path& path);

}  // namespace strainwave::bench
