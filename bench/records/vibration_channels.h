// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "daq/record.h"

namespace strainwave::bench {

/// What the columns of a vibration record are.
struct VibrationColumns {
  std::vector<std::string> channels;  // in the record's order
  /// Column and sentence: what is left out that no other part of the program reads, and what is taken with a
  /// warning.
  std::vector<std::pair<std::string, std::string>> warnings;
};

/// A channel is a column of numbers under a name that ends in a unit (docs/contract.md#record-files). None
/// are time, the shafts' angles, torque, speed and temperature of the gear, and labels of a predictor; nor,
/// with a warning:
///  - names that stand for time, an index or a label ("Time", "sample_no", "target"), and units of time;
///  - columns that go on evenly or by one step a sample, as time and indices do, whatever their name;
///  - names without a unit, where another column has one; where none has, those of one value.
VibrationColumns SortVibrationColumns(const daq::Record& record);

}  // namespace strainwave::bench
