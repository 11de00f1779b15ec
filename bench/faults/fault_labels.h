// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "bench/data_sets/labels.h"

namespace strainwave::bench {

/// Rows of `labels.csv` whose cell in a column is one of some values.
struct LabelFilter {
  std::string column;
  std::vector<std::string> values;
};
/// @param text  COLUMN=VALUE or COLUMN=VALUE,VALUE.
/// @throws BenchError for another form.
LabelFilter LabelFilterOf(const std::string& text);

enum class FaultTargets { kAsThere, kClasses, kLabels };

/// What the chosen rows show, and how they belong together.
struct FaultLabels {
  struct Group {
    std::string column;
    std::vector<std::string> value;  // one a row
  };
  std::vector<std::size_t> rows;     // of the table
  std::vector<std::string> outputs;  // classes, sorted; or labels, in the order of the table
  bool labels{};                     // several may be there at once
  Eigen::MatrixXd targets;           // rows × outputs, 0 or 1
  std::vector<std::string> unit;     // one a row
  std::vector<Group> groups;         // by the columns to split by
  std::vector<std::string> limits;   // in words
};

/// @param targets  as there: `class` where there is that column, else `fault_NAME`.
/// @throws BenchError (exit code 2), at the cell where there is one, if no row is left, neither `class` nor
///   `fault_NAME` is there, a class is empty, a fault is neither 0 nor 1, all rows show the same, or a column
///   to split by is missing.
FaultLabels FaultLabelsOf(const Labels& table, const std::vector<LabelFilter>& filters, FaultTargets targets,
                          const std::vector<std::string>& split_columns);

}  // namespace strainwave::bench
