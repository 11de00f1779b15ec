// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "daq/record.h"

/// Of a CSV record while it is being read: its columns, and what is wrong where.
namespace strainwave::daq {

// A file with more bad cells than this is read no further: the message shows fewer anyway.
inline constexpr std::size_t kMostBadCells = 100;
// And whatever else is found in it.
inline constexpr std::size_t kMostFindings = 1000;

struct Place {
  int line{};
  int column{};
};

struct PlacedFinding {
  Place place;
  std::string what;
  std::string expected;
};

// A column while it is being read. Bad cells are kept apart until it is known whether the column is needed.
struct CsvColumn {
  std::string name;
  bool is_direction{};
  bool is_known{};  // its cells must be good
  std::vector<double> numbers;
  std::vector<Direction> directions;
  std::vector<PlacedFinding> bad_cells;
  std::set<std::size_t> bad_rows;
  std::size_t good_numbers{};
};

}  // namespace strainwave::daq
