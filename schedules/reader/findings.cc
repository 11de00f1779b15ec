// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <tuple>
#include <utility>

namespace strainwave::schedules {
namespace {

constexpr std::size_t kMostFindings = 1000;

std::vector<Finding> SortedErrors(const FindingList& list) {
  std::vector<Finding> errors;
  std::copy_if(list.items().begin(), list.items().end(), std::back_inserter(errors),
               [](const Finding& finding) { return finding.severity == Severity::kError; });
  std::stable_sort(errors.begin(), errors.end(), [](const Finding& a, const Finding& b) {
    return std::tie(a.line, a.column) < std::tie(b.line, b.column);
  });
  return errors;
}

std::string Joined(std::string_view file_name, const FindingList& list) {
  std::string text;
  for (const Finding& finding : SortedErrors(list)) {
    if (!text.empty()) text += '\n';
    text += FormatFinding(file_name, finding);
  }
  if (list.not_kept() > 0) text += fmt::format("\n{}: error: and {} more", file_name, list.not_kept());
  return text;
}

}  // namespace

std::string FormatFinding(std::string_view file_name, const Finding& finding) {
  const std::string_view severity = finding.severity == Severity::kError ? "error" : "warning";
  if (finding.line <= 0) return fmt::format("{}: {}: {}", file_name, severity, finding.message);
  return fmt::format("{}:{}:{}: {}: {}", file_name, finding.line, finding.column, severity, finding.message);
}

void FindingList::AddError(int line, int column, std::string message) {
  has_errors_ = true;
  Add({line, column, std::move(message), Severity::kError});
}

void FindingList::AddWarning(int line, int column, std::string message) {
  Add({line, column, std::move(message), Severity::kWarning});
}

void FindingList::Append(const FindingList& other) {
  for (const Finding& finding : other.items_) Add(finding);
  not_kept_ += other.not_kept_;
  has_errors_ = has_errors_ || other.has_errors_;
}

void FindingList::Add(Finding finding) {
  if (items_.size() < kMostFindings) {
    items_.push_back(std::move(finding));
  } else {
    ++not_kept_;
  }
}

FileError::FileError(std::string_view file_name, const FindingList& findings)
    : std::runtime_error(Joined(file_name, findings)), findings_(SortedErrors(findings)) {}

}  // namespace strainwave::schedules
