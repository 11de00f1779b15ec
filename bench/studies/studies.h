// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace strainwave::bench {

/// What a simulated data set is made with.
struct StudySettings {
  std::filesystem::path out;  // a folder that is not there yet, or empty
  std::uint64_t seed{1};
  std::optional<int> units{};  // assemblies a condition; none: as many as the study has by default
  /// Told after each record.
  std::function<void(std::size_t done, std::size_t all)> progress = [](std::size_t, std::size_t) {};
};

/// What was written.
struct StudySummary {
  std::size_t files{};
  std::size_t units{};
  std::vector<std::string> label_columns;
};

/// A data set that `simulate --study NAME` makes: records and `labels.csv`.
struct Study {
  std::string_view name;
  std::string_view what;  // for --help
  StudySummary (*make)(const StudySettings& settings);
};

std::span<const Study> Studies();

/// Makes the folder and calls the study of that name.
/// @throws BenchError (exit code 2) for an unknown name, fewer than one unit, or a folder that holds
/// anything.
StudySummary MakeStudy(std::string_view name, const StudySettings& settings);

/// Collects rows of `labels.csv`, and writes it at the end.
class LabelsWriter {
 public:
  /// @param columns  beside `file` and `unit`
  explicit LabelsWriter(std::vector<std::string> columns) : columns_(std::move(columns)) {}
  /// @param values  one a column, without commas
  void Add(const std::string& file, const std::string& unit, const std::vector<std::string>& values);
  /// @throws BenchError (exit code 3) if it cannot be written.
  StudySummary Write(const std::filesystem::path& folder) const;

 private:
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace strainwave::bench
