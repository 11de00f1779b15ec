// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hdf5.h>

#include <optional>
#include <string>
#include <vector>

#include "daq/cycle_file.h"
#include "daq/record.h"

/// Columns of a record as one-dimensional datasets.
namespace strainwave::daq {

/// Writes the values in chunks with a Fletcher-32 checksum each, and the attributes `unit`, `sensor_serial`
/// and `calibration` where there is something to say, and `sample_rate_hz` where it is given. @throws
/// Hdf5Error.
void WriteColumn(hid_t group, const Column& column, const std::optional<std::string>& sample_rate_hz,
                 Packing packing = Packing::kPlain);

/// Something in a dataset that keeps it from being a column.
struct ColumnTrouble {
  std::optional<std::size_t> row;
  std::string what;
  std::string expected;
};

enum class ColumnType { kDouble, kFloatIfStoredSo, kDirection };

/// Reads a dataset of one dimension (or of more, if all but one have length 1, as MATLAB writes) of floats,
/// integers, or, for a direction, of words as text or enumeration, or of 1 and -1 (direction_words.h).
/// Trouble instead of values where it cannot: another type, values that were never written, a checksum that
/// does not match, a compression that this HDF5 does not have.
struct ReadColumnResult {
  Column column;
  std::vector<ColumnTrouble> troubles;
};
/// @param described  with sensor and calibration, which take longer than the values of a short column.
ReadColumnResult ReadColumn(hid_t dataset, const std::string& name, ColumnType type, bool described = true);

/// Names of the values in each row of a dataset of compound rows, as tables of h5py, PyTables and pandas are;
/// empty for any other dataset. @throws Hdf5Error for more of them than a record has columns.
std::vector<std::string> MembersOf(hid_t dataset);

/// `ReadColumn` for one of the members, which gives the column its name.
ReadColumnResult ReadMember(hid_t dataset, const std::string& member, ColumnType type);

}  // namespace strainwave::daq
