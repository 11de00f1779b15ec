// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "daq/cycle_file.h"

/// HDF5 files of plain arrays: features of a campaign, the numbers of a predictor.
namespace strainwave::daq {

/// Row-major values of one shape.
struct NamedArray {
  std::string name;
  std::vector<std::size_t> shape;
  std::vector<double> values;
};

struct ArraysFile {
  Attributes attributes;
  std::vector<NamedArray> arrays;  // in the order written

  /// Nothing of that name: nullptr.
  const NamedArray* Find(std::string_view name) const;
};

/// Writes the arrays as doubles into one file that appears whole or not at all.
/// @throws std::invalid_argument if a shape does not fit its values; DataFileError.
void WriteArraysAtomically(const std::filesystem::path& path, const ArraysFile& file);

/// Read in a process of its own (`record_pipe.h`); no other thread may be within HDF5 meanwhile.
/// @throws RecordError if the file is missing, cut, not HDF5, or holds something else than arrays of numbers.
ArraysFile ReadArrays(const std::filesystem::path& path);

}  // namespace strainwave::daq
