// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "daq/csv_text.h"

namespace strainwave::bench {

/// What `labels.csv` of a folder says of its records: `file` and `unit`, and any further columns.
/// Rows are in the order of the file.
class Labels {
 public:
  struct Row {
    std::filesystem::path file;  // below the folder, as it is to be opened
    std::string name;            // as the table has it
    std::string unit;            // the assembly or specimen
    int line{};
    std::vector<daq::Cell> cells;  // of all columns
  };

  Labels(std::filesystem::path path, std::vector<std::string> columns, std::vector<Row> rows);

  const std::filesystem::path& path() const { return path_; }
  const std::vector<Row>& rows() const { return rows_; }
  /// All but `file` and `unit`.
  std::vector<std::string> columns() const;
  bool Has(std::string_view column) const;
  /// Of "health_hd" and "health_tb" under the prefix "health_": hd, tb, in the order of the table.
  std::vector<std::string> WithPrefix(std::string_view prefix) const;

  /// One a row. @throws BenchError if there is no such column.
  std::vector<std::string> Texts(std::string_view column) const;
  /// One a row. @throws BenchError with line and column of the cell that is not a number from `low` to
  /// `high`.
  std::vector<double> Numbers(std::string_view column, double low, double high) const;
  std::vector<std::string> Units() const;

  /// @throws BenchError "FILE:LINE:COLUMN: error: WHAT (expected EXPECTED)" at a cell; the line alone where
  /// the column is not there.
  [[noreturn]] void RefuseCell(std::size_t row, std::string_view column, const std::string& what,
                               const std::string& expected) const;

 private:
  std::size_t ColumnOf(std::string_view name) const;

  std::filesystem::path path_;
  std::vector<std::string> columns_;
  std::vector<Row> rows_;
};

/// Reads `labels.csv` of a folder.
/// @throws BenchError (exit code 2) if the folder or the table is missing, is no text, has no column `file`
/// or `unit`, a column or a file twice, an empty unit, a row of another width, or names a file that is not
/// there or lies outside the folder.
Labels ReadLabels(const std::filesystem::path& folder);

/// Consecutive numbers for equal texts, in the order of their first appearance.
std::vector<int> NumbersOfGroups(const std::vector<std::string>& groups);

}  // namespace strainwave::bench
