// SPDX-License-Identifier: Apache-2.0
#include "daq/record_error.h"

#include <fmt/format.h>

#include <algorithm>

namespace strainwave::daq {
namespace {

std::string TextOf(const std::vector<Finding>& findings) {
  std::string text;
  const std::size_t shown = std::min(findings.size(), RecordError::kMostShown);
  for (std::size_t i = 0; i < shown; ++i) {
    const Finding& finding = findings[i];
    if (i > 0) text += '\n';
    text += fmt::format("{}: error: {} (expected {})", finding.place, finding.what, finding.expected);
  }
  if (findings.size() > shown) text += fmt::format("\nand {} more errors", findings.size() - shown);
  return text;
}

}  // namespace

RecordError::RecordError(std::vector<Finding> findings)
    : std::runtime_error(TextOf(findings)), findings_(std::move(findings)) {}

}  // namespace strainwave::daq
