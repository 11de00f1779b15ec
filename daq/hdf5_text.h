// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

/// Texts and named values of HDF5 in whichever way a file holds them.
namespace strainwave::daq {

/// Where values come from, a dataset or an attribute: `read(memory_type, buffer)` fills `count` of them.
struct Hdf5Values {
  hid_t type;   // as in the file
  hid_t space;  // of the values
  std::size_t count;
  bool is_attribute;
  hid_t object;
  std::string member{};  // of rows of several values: which of them; `type` is its own

  /// @throws Hdf5Error.
  void Read(hid_t memory_type, void* buffer) const;
};

/// Values of a string type, fixed or variable in length, without their padding. @throws Hdf5Error.
std::vector<std::string> ReadTexts(const Hdf5Values& values);

/// One value of an enumeration: its name, empty if the value has none, and its number.
struct NamedValue {
  std::string name;
  long long number;
};
std::vector<NamedValue> ReadNamedValues(const Hdf5Values& values);

}  // namespace strainwave::daq
