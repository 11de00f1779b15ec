// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "tests/checkout.h"

namespace strainwave::testing_data {

/// The folder of values that PyWavelets, tsfresh and PyTorch gave: STRAINWAVE_GOLDEN, or ../shared/golden
/// beside the checkout, or nothing.
inline std::optional<std::filesystem::path> GoldenFolder() {
  const char* named = std::getenv("STRAINWAVE_GOLDEN");
  const std::filesystem::path folder =
      named != nullptr ? named : std::filesystem::path(SourceFolder()) / "../shared/golden";
  if (!std::filesystem::exists(folder / "tsfresh_features.csv")) return std::nullopt;
  return folder;
}

inline constexpr const char* kNoGolden =
    "skipped, because there are no golden values (STRAINWAVE_GOLDEN, or ../shared/golden)";

/// Columns of numbers by name; shorter columns end in empty cells.
inline std::map<std::string, std::vector<double>> GoldenColumns(const std::string& file) {
  std::ifstream stream(*GoldenFolder() / file);
  std::map<std::string, std::vector<double>> columns;
  std::vector<std::string> names;
  std::string line;
  std::string cell;
  std::getline(stream, line);
  for (std::istringstream header(line); std::getline(header, cell, ',');) names.push_back(cell);
  while (std::getline(stream, line)) {
    std::istringstream row(line);
    for (std::size_t i = 0; std::getline(row, cell, ','); ++i) {
      if (!cell.empty() && cell != "\r") columns[names.at(i)].push_back(std::stod(cell));
    }
  }
  return columns;
}

}  // namespace strainwave::testing_data
