// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace strainwave::schedules {

enum class Severity { kError, kWarning };

/// One thing that is wrong, or questionable, in a file. Lines and columns count from 1; line 0 is the whole
/// file.
struct Finding {
  int line{};
  int column{};
  std::string message;  // "WHAT (what was expected)"
  Severity severity{Severity::kError};
};

/// `FILE:LINE:COLUMN: error: WHAT (what was expected)`, or without the place when the finding has none.
std::string FormatFinding(std::string_view file_name, const Finding& finding);

/// All findings of one file, in the order in which they were made. Keeps the first thousand and counts the
/// rest: a file of nothing but mistakes must not fill the memory.
class FindingList {
 public:
  void AddError(int line, int column, std::string message);
  void AddWarning(int line, int column, std::string message);
  void Append(const FindingList& other);

  bool has_errors() const { return has_errors_; }
  const std::vector<Finding>& items() const& { return items_; }
  std::vector<Finding> items() && { return std::move(items_); }  // a loop over a temporary list is safe
  std::size_t not_kept() const { return not_kept_; }

 private:
  void Add(Finding finding);

  std::vector<Finding> items_;
  std::size_t not_kept_{};
  bool has_errors_{};
};

/// An input file that cannot be used. what() is one line a finding, sorted by place; warnings are left out.
class FileError : public std::runtime_error {
 public:
  FileError(std::string_view file_name, const FindingList& findings);

  /// The errors, sorted by line and column.
  const std::vector<Finding>& findings() const { return findings_; }

 private:
  std::vector<Finding> findings_;
};

/// A schedule that cannot be used.
class ScheduleError : public FileError {
 public:
  using FileError::FileError;
};

/// Where a value stood in its file, and how it was written there.
struct Origin {
  int line{};  // 0: a default, not in the file
  int column{};
  std::string text;  // "30 min"
  bool wrong{};      // unreadable or missing; a stand-in value is in its place
};

/// Origins by path: "limits.output_torque", "phases[2].duration".
using Origins = std::map<std::string, Origin, std::less<>>;

}  // namespace strainwave::schedules
