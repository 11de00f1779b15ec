// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hdf5.h>

#include <string>
#include <vector>

/// Attributes of HDF5 objects as text.
namespace strainwave::daq {

struct Hdf5Attribute {
  std::string name;
  std::string text;  // of a number: the shortest that reads back to the same bits
};

/// Writes `text` as a double where that reads back to the same text, else as text. @throws Hdf5Error.
void WriteAttribute(hid_t object, const std::string& name, const std::string& text);
void WriteTextAttribute(hid_t object, const std::string& name, const std::string& text);
/// Of an object with so many attributes: they stay in its header, whatever their number. Beyond eight the
/// library puts them into a heap, which few other readers know.
void KeepAttributesInHeader(hid_t creation_properties, std::size_t attributes);
/// Of a new file, before anything else: which program writes it (`software.h`). @throws Hdf5Error.
void WriteSoftware(hid_t file);

/// All attributes that hold one text, number, or named value (h5py's booleans become "true" and "false"), in
/// the order of creation where the object keeps it and else by name. Others are named in `left_out`.
/// @throws Hdf5Error.
std::vector<Hdf5Attribute> ReadAttributes(hid_t object, std::vector<std::string>& left_out);

/// The index to go through an object's links or attributes by; `creation_order_flags` as its property list
/// says.
inline H5_index_t IndexFor(unsigned creation_order_flags) {
  return (creation_order_flags & H5P_CRT_ORDER_TRACKED) != 0 ? H5_INDEX_CRT_ORDER : H5_INDEX_NAME;
}

}  // namespace strainwave::daq
