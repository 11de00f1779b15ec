// SPDX-License-Identifier: Apache-2.0
#include "bench/health/health_data.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/health/levels.h"
#include "bench/data_sets/labels.h"
#include "bench/errors/bench_error.h"
#include "bench/health/motor_records.h"
#include "bench/sha256.h"
#include "daq/record.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

namespace health = analysis::health;

constexpr const char* kSystem = "system_rms";

Eigen::MatrixXd HealthOf(const Labels& labels, const std::vector<std::string>& components) {
  Eigen::MatrixXd values(static_cast<Eigen::Index>(labels.rows().size()),
                         static_cast<Eigen::Index>(components.size()));
  for (std::size_t c = 0; c < components.size(); ++c) {
    const std::vector<double> column = labels.Numbers(kHealthPrefix + components[c], 0.0, 1.0);
    for (std::size_t r = 0; r < column.size(); ++r)
      values(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) = column[r];
  }
  return values;
}

// What the labels cannot teach is refused before any record is read.
void RequireTellable(const Labels& labels, const std::vector<std::string>& components,
                     const Eigen::MatrixXd& values) {
  for (std::size_t c = 0; c < components.size(); ++c) {
    const auto column = values.col(static_cast<Eigen::Index>(c));
    if (column.minCoeff() == column.maxCoeff())
      labels.RefuseCell(0, kHealthPrefix + components[c],
                        fmt::format("{}{} is {:g} in every row", kHealthPrefix, components[c], column(0)),
                        "two levels of each component or more");
  }
  const int distinct = health::DistinguishableComponents(values);
  if (distinct < values.cols()) {
    std::vector<std::string> columns;
    for (const std::string& name : components) columns.push_back(kHealthPrefix + name);
    labels.RefuseCell(0, columns.back(),
                      fmt::format("{} change together: the data can tell {} of {} components apart",
                                  fmt::join(columns, ", "), distinct, columns.size()),
                      "conditions in which each changes by itself");
  }
}

// Distinct rows, in the order of their health.
std::vector<int> NumberConditions(const Eigen::MatrixXd& values, Eigen::MatrixXd& conditions) {
  std::map<std::vector<double>, int> numbers;
  const auto key = [&values](Eigen::Index row) {
    const Eigen::VectorXd point = values.row(row);
    return std::vector<double>(point.begin(), point.end());
  };
  for (Eigen::Index i = 0; i < values.rows(); ++i) numbers[key(i)] = 0;
  conditions.resize(static_cast<Eigen::Index>(numbers.size()), values.cols());
  int next = 0;
  for (auto& [point, number] : numbers) {
    conditions.row(next) = Eigen::Map<const Eigen::RowVectorXd>(point.data(), values.cols());
    number = next++;
  }
  std::vector<int> of_row;
  for (Eigen::Index i = 0; i < values.rows(); ++i) of_row.push_back(numbers[key(i)]);
  return of_row;
}

std::vector<SystemValue> SystemValuesOf(const Labels& labels, const Eigen::MatrixXd& values,
                                        const std::vector<int>& condition, const std::vector<int>& unit,
                                        std::vector<std::string>& notes) {
  std::vector<SystemValue> system;
  if (!labels.Has(kSystem)) return system;
  const std::vector<std::string> texts = labels.Texts(kSystem);
  std::set<std::tuple<int, int, double>> seen;
  std::size_t repeated = 0;
  for (std::size_t r = 0; r < texts.size(); ++r) {
    if (texts[r].empty()) continue;
    const auto number = daq::NumberFromText(texts[r]);
    if (!number || !std::isfinite(*number) || *number < 0.0)
      labels.RefuseCell(r, kSystem, fmt::format("{} is {}", kSystem, daq::Quoted(texts[r])),
                        "a number from 0 up, or nothing where it was not measured");
    if (!seen.emplace(condition[r], unit[r], *number).second) {
      ++repeated;
      continue;
    }
    system.push_back({values.row(static_cast<Eigen::Index>(r)), unit[r], *number});
  }
  if (repeated > 0)
    notes.push_back(
        fmt::format("{} values of {} repeat one of the same unit and condition to the last digit and "
                    "count once: {} measurements",
                    repeated, kSystem, system.size()));
  return system;
}

// Conditions without records, in which the system failed.
Eigen::MatrixXd FailedConditions(const std::filesystem::path& folder,
                                 const std::vector<std::string>& components) {
  const std::filesystem::path path = folder / kFailedConditions;
  if (!std::filesystem::exists(path)) return Eigen::MatrixXd(0, static_cast<Eigen::Index>(components.size()));
  const std::string text = daq::ReadWholeFile(path);
  std::string_view rest = text;
  std::vector<std::string> columns;
  std::set<std::vector<double>> rows;
  for (int number = 1; !rest.empty(); ++number) {
    const std::string_view line = daq::TakeLine(rest).text;
    if (daq::Trim(line).empty()) continue;
    const std::vector<daq::Cell> cells = daq::SplitCells(line, ',');
    if (columns.empty()) {
      for (const daq::Cell& cell : cells) columns.push_back(cell.text);
      continue;
    }
    std::vector<double> point;
    for (const std::string& component : components) {
      const auto found = std::ranges::find(columns, kHealthPrefix + component);
      const auto at = static_cast<std::size_t>(found - columns.begin());
      const auto value = at < cells.size() ? daq::NumberFromText(cells[at].text) : std::nullopt;
      if (!value || !(*value >= 0.0 && *value <= 1.0))
        Refuse(fmt::format("{}:{}", path.string(), number),
               fmt::format("there is no {}{} in this row", kHealthPrefix, component), "a number from 0 to 1");
      point.push_back(*value);
    }
    rows.insert(point);
  }
  Eigen::MatrixXd failed(static_cast<Eigen::Index>(rows.size()),
                         static_cast<Eigen::Index>(components.size()));
  Eigen::Index at = 0;
  for (const std::vector<double>& point : rows)
    failed.row(at++) = Eigen::Map<const Eigen::RowVectorXd>(point.data(), failed.cols());
  return failed;
}

void NoteLimits(HealthData& data, const std::vector<int>& condition, const std::vector<int>& unit) {
  std::map<int, std::set<int>> conditions_of_unit;
  std::map<int, std::set<int>> units_of_condition;
  for (std::size_t r = 0; r < unit.size(); ++r) {
    conditions_of_unit[unit[r]].insert(condition[r]);
    units_of_condition[condition[r]].insert(unit[r]);
  }
  if (std::ranges::all_of(units_of_condition, [](const auto& entry) { return entry.second.size() == 1; }) &&
      data.units.size() > 1)
    data.notes.push_back(
        "each condition was recorded on one unit alone: what belongs to the unit cannot be told from what "
        "belongs to "
        "its health, and leaving a unit out leaves a condition out");
  const auto several =
      std::ranges::count_if(conditions_of_unit, [](const auto& e) { return e.second.size() > 1; });
  if (several > 0)
    data.notes.push_back(
        fmt::format("{} of {} units were recorded in several conditions", several, data.units.size()));
  const Eigen::MatrixXi levels = health::LevelsOf(data.conditions);
  double cells = 1.0;
  for (Eigen::Index c = 0; c < levels.cols(); ++c) cells *= levels.col(c).maxCoeff() + 1.0;
  std::set<std::vector<int>> there;
  for (Eigen::Index i = 0; i < levels.rows(); ++i) {
    std::vector<int> cell;
    for (Eigen::Index c = 0; c < levels.cols(); ++c) cell.push_back(levels(i, c));
    there.insert(cell);
  }
  if (static_cast<double>(there.size()) < cells)
    data.notes.push_back(fmt::format("{} of {:g} combinations of levels were recorded", there.size(), cells));
  if (data.failed.rows() > 0)
    data.notes.push_back(
        fmt::format("{} conditions failed and have no records: the system is at its limit or above "
                    "there",
                    data.failed.rows()));
}

std::string HashOf(const analysis::prediction::Samples& samples) {
  std::string bytes(reinterpret_cast<const char*>(samples.features.data()),
                    static_cast<std::size_t>(samples.features.size()) * sizeof(double));
  bytes.append(reinterpret_cast<const char*>(samples.targets.data()),
               static_cast<std::size_t>(samples.targets.size()) * sizeof(double));
  return Sha256(bytes);
}

// The same words of many files, once.
void AddWarnings(std::vector<RecordWarning>& all, std::map<std::string, std::size_t>& counts,
                 const std::vector<RecordWarning>& more) {
  for (const RecordWarning& warning : more) {
    if (++counts[warning.text] == 1) all.push_back(warning);
  }
}

}  // namespace

HealthData ReadHealthData(const RecordReader& reader, const std::filesystem::path& folder,
                          const analysis::features::PacketRecipe& recipe, const HealthProgress& progress) {
  const Labels labels = ReadLabels(folder);
  HealthData data;
  data.folder = folder;
  data.recipe = recipe;
  data.components = labels.WithPrefix(kHealthPrefix);
  if (data.components.empty())
    Refuse(fmt::format("{}:1:1", labels.path().string()), "there is no column health_NAME",
           fmt::format("one a component, beside {}", fmt::join(labels.columns(), ", ")));
  const Eigen::MatrixXd values = HealthOf(labels, data.components);
  RequireTellable(labels, data.components, values);
  const std::vector<int> condition = NumberConditions(values, data.conditions);
  const std::vector<int> unit = NumbersOfGroups(labels.Units());
  for (std::size_t r = 0; r < unit.size(); ++r) {
    if (static_cast<std::size_t>(unit[r]) == data.units.size()) data.units.push_back(labels.rows()[r].unit);
  }
  data.system = SystemValuesOf(labels, values, condition, unit, data.notes);
  data.failed = FailedConditions(folder, data.components);

  analysis::features::PacketFeatures features(recipe);
  data.shortest = std::numeric_limits<std::size_t>::max();
  std::vector<MotorFeatures> records;
  std::vector<std::size_t> row_of_record;
  std::map<std::string, std::size_t> told;
  std::size_t cycles = 0;
  for (std::size_t r = 0; r < labels.rows().size(); ++r) {
    const Labels::Row& row = labels.rows()[r];
    progress("reading " + row.name, static_cast<double>(r) / static_cast<double>(labels.rows().size()));
    data.files.push_back(row.name);
    for (MotorFeatures& record : FeaturesOfMotorFile(reader, row.file, features, {})) {
      if (records.empty()) {
        data.sample_rate_hz = record.sample_rate_hz;
        data.cut = record.cut;
      } else if (std::abs(record.sample_rate_hz - data.sample_rate_hz) > 0.01 * data.sample_rate_hz) {
        Refuse(row.file, fmt::format("the sampling rate is {:g} Hz", record.sample_rate_hz),
               fmt::format("{:g} Hz, as in {}", data.sample_rate_hz, labels.rows().front().name));
      }
      data.shortest = std::min(data.shortest, record.shortest);
      data.longest = std::max(data.longest, record.longest);
      AddWarnings(data.warnings, told, record.warnings);
      constexpr std::size_t kMostExamples = 16;
      if (data.examples.size() < kMostExamples &&
          std::ranges::find(data.examples, condition[r], &MotorExample::condition) == data.examples.end())
        data.examples.push_back({condition[r], std::move(record.first_cycle)});
      record.first_cycle.clear();
      cycles += static_cast<std::size_t>(record.values.rows());
      records.push_back(std::move(record));
      row_of_record.push_back(r);
    }
  }
  for (RecordWarning& warning : data.warnings) {
    const std::size_t count = told[warning.text];
    if (count > 1) warning.text += fmt::format(" (in {} records)", count);
  }
  data.samples.inputs = features.Names(kMotorChannels);
  data.samples.outputs = data.components;
  const auto n = static_cast<Eigen::Index>(cycles);
  data.samples.features.resize(n, static_cast<Eigen::Index>(data.samples.inputs.size()));
  data.samples.targets.resize(n, values.cols());
  Eigen::Index at = 0;
  std::vector<int> seen(data.units.size(), 0);
  std::size_t floored = 0;
  for (std::size_t k = 0; k < records.size(); ++k) {
    const std::size_t r = row_of_record[k];
    floored += records[k].floored;
    for (Eigen::Index i = 0; i < records[k].values.rows(); ++i, ++at) {
      data.samples.features.row(at) = records[k].values.row(i);
      data.samples.targets.row(at) = values.row(static_cast<Eigen::Index>(r));
      data.samples.specimen.push_back(unit[r]);
      data.samples.cycle.push_back(seen[static_cast<std::size_t>(unit[r])]++);
      data.condition.push_back(condition[r]);
      data.file.push_back(static_cast<int>(r));
    }
  }
  NoteLimits(data, condition, unit);
  if (floored > 0)
    data.notes.push_back(fmt::format(
        "{} coefficients are next to zero: their logarithm is that of the smallest number", floored));
  data.sha256 = HashOf(data.samples);
  return data;
}

}  // namespace strainwave::bench
