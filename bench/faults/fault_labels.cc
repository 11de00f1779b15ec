// SPDX-License-Identifier: Apache-2.0
#include "bench/faults/fault_labels.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

constexpr const char* kClass = "class";
constexpr const char* kFaultPrefix = "fault_";

std::vector<std::size_t> RowsThatPass(const Labels& table, const std::vector<LabelFilter>& filters) {
  std::vector<bool> passes(table.rows().size(), true);
  for (const LabelFilter& filter : filters) {
    const std::vector<std::string> cells = table.Texts(filter.column);
    for (std::size_t row = 0; row < cells.size(); ++row) {
      if (std::ranges::find(filter.values, cells[row]) == filter.values.end()) passes[row] = false;
    }
  }
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < passes.size(); ++row) {
    if (passes[row]) rows.push_back(row);
  }
  if (rows.empty()) Refuse(table.path(), "no row passes --where", "values that stand in its columns");
  return rows;
}

void ReadClasses(const Labels& table, FaultLabels& result) {
  const std::vector<std::string> cells = table.Texts(kClass);
  std::set<std::string> classes;
  for (const std::size_t row : result.rows) {
    if (cells[row].empty()) table.RefuseCell(row, kClass, "class is empty", "the name of a class");
    classes.insert(cells[row]);
  }
  if (classes.size() < 2)
    Refuse(table.path(), fmt::format("class is '{}' in every record", *classes.begin()),
           "records of two classes or more");
  result.outputs.assign(classes.begin(), classes.end());
  result.targets = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(result.rows.size()),
                                         static_cast<Eigen::Index>(classes.size()));
  std::map<std::string, int> records;
  for (std::size_t i = 0; i < result.rows.size(); ++i) {
    const std::string& name = cells[result.rows[i]];
    const auto place = std::ranges::find(result.outputs, name) - result.outputs.begin();
    result.targets(static_cast<Eigen::Index>(i), place) = 1.0;
    ++records[name];
  }
  for (const auto& [name, count] : records) {
    if (count == 1)
      result.limits.push_back(
          fmt::format("class {} has one record: nothing that learnt it can be tested on it", name));
  }
}

void ReadLabels(const Labels& table, FaultLabels& result) {
  std::vector<std::vector<double>> columns;
  for (const std::string& name : table.WithPrefix(kFaultPrefix)) {
    const std::string column = kFaultPrefix + name;
    const std::vector<std::string> cells = table.Texts(column);
    std::vector<double> values;
    for (const std::size_t row : result.rows) {
      if (cells[row] != "0" && cells[row] != "1")
        table.RefuseCell(row, column, fmt::format("{} is '{}'", column, cells[row]), "0 or 1");
      values.push_back(cells[row] == "1" ? 1.0 : 0.0);
    }
    const auto [least, most] = std::ranges::minmax(values);
    if (least == most) {
      result.limits.push_back(
          fmt::format("{} is {} in every record: it cannot be learnt and is left out", column, least));
      continue;
    }
    result.outputs.push_back(name);
    columns.push_back(std::move(values));
  }
  if (columns.empty())
    Refuse(table.path(), "each column fault_NAME is the same in every record",
           "one with records of 0 and of 1");
  result.targets.resize(static_cast<Eigen::Index>(result.rows.size()),
                        static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k)
    result.targets.col(static_cast<Eigen::Index>(k)) =
        Eigen::Map<const Eigen::VectorXd>(columns[k].data(), result.targets.rows());
}

// An assembly that was seen in two states is left out with both.
void TellUnitsOfSeveral(FaultLabels& result) {
  std::map<std::string, std::set<std::vector<double>>> shown;
  for (std::size_t i = 0; i < result.rows.size(); ++i) {
    const Eigen::RowVectorXd row = result.targets.row(static_cast<Eigen::Index>(i));
    shown[result.unit[i]].insert({row.begin(), row.end()});
  }
  std::vector<std::string> units;
  for (const auto& [unit, patterns] : shown) {
    if (patterns.size() > 1) units.push_back(unit);
  }
  if (units.empty()) return;
  result.limits.push_back(
      fmt::format("unit {} has records of more than one {}{}: where a unit is left out, all of it is",
                  units.front(), result.labels ? "set of faults" : "class",
                  units.size() > 1 ? fmt::format(", and so have {} others", units.size() - 1) : ""));
}

}  // namespace

LabelFilter LabelFilterOf(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos)
    Refuse("--where", fmt::format("'{}'", text), "COLUMN=VALUE or COLUMN=VALUE,VALUE");
  LabelFilter filter{.column = text.substr(0, equals), .values = {}};
  for (std::size_t begin = equals + 1;;) {
    const std::size_t comma = text.find(',', begin);
    filter.values.push_back(text.substr(begin, comma == std::string::npos ? comma : comma - begin));
    if (comma == std::string::npos) return filter;
    begin = comma + 1;
  }
}

FaultLabels FaultLabelsOf(const Labels& table, const std::vector<LabelFilter>& filters, FaultTargets targets,
                          const std::vector<std::string>& split_columns) {
  FaultLabels result;
  result.rows = RowsThatPass(table, filters);
  const bool has_class = table.Has(kClass);
  const bool has_faults = !table.WithPrefix(kFaultPrefix).empty();
  result.labels = targets == FaultTargets::kLabels || (targets == FaultTargets::kAsThere && !has_class);
  if (result.labels ? !has_faults : !has_class)
    Refuse(fmt::format("{}:1:1", table.path().string()),
           result.labels && targets == FaultTargets::kLabels ? "there is no column fault_NAME"
                                                             : "there is no column class and no fault_NAME",
           result.labels && targets == FaultTargets::kLabels ? "a column of 0 and 1 for each fault"
                                                             : "what each record shows in one of these");
  for (const std::size_t row : result.rows) result.unit.push_back(table.rows()[row].unit);
  result.labels ? ReadLabels(table, result) : ReadClasses(table, result);
  for (const std::string& column : split_columns) {
    const std::vector<std::string> cells = column == "unit" ? table.Units() : table.Texts(column);
    FaultLabels::Group group{.column = column, .value = {}};
    for (const std::size_t row : result.rows) group.value.push_back(cells[row]);
    result.groups.push_back(std::move(group));
  }
  TellUnitsOfSeveral(result);
  return result;
}

}  // namespace strainwave::bench
