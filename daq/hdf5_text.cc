// SPDX-License-Identifier: Apache-2.0
#include "daq/hdf5_text.h"

#include <cstring>

#include "daq/hdf5_handle.h"

namespace strainwave::daq {
namespace {

std::vector<std::string> ReadVariableTexts(const Hdf5Values& values) {
  const Hdf5Handle memory_type(H5Tcopy(H5T_C_S1), H5Tclose);
  Check(H5Tset_size(memory_type.get(), H5T_VARIABLE));
  // HDF5 does not convert between ASCII and UTF-8, not even where they are the same.
  Check(H5Tset_cset(memory_type.get(), H5Tget_cset(values.type)));
  std::vector<char*> pointers(values.count, nullptr);
  values.Read(memory_type.get(), pointers.data());
  std::vector<std::string> texts;
  for (const char* pointer : pointers) texts.emplace_back(pointer == nullptr ? "" : pointer);
  H5Dvlen_reclaim(memory_type.get(), values.space, H5P_DEFAULT, pointers.data());
  return texts;
}

std::vector<std::string> ReadFixedTexts(const Hdf5Values& values) {
  const std::size_t width = H5Tget_size(values.type);
  const bool space_padded = H5Tget_strpad(values.type) == H5T_STR_SPACEPAD;
  std::vector<char> bytes(width * values.count);
  values.Read(values.type, bytes.data());
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < values.count; ++i) {
    const char* start = bytes.data() + i * width;
    std::string text(start, strnlen(start, width));
    while (space_padded && text.ends_with(' ')) text.pop_back();
    texts.push_back(std::move(text));
  }
  return texts;
}

}  // namespace

void Hdf5Values::Read(hid_t memory_type, void* buffer) const {
  if (!member.empty()) {
    const Hdf5Handle row_type(H5Tcreate(H5T_COMPOUND, H5Tget_size(memory_type)), H5Tclose);
    Check(H5Tinsert(row_type.get(), member.c_str(), 0, memory_type));
    Check(H5Dread(object, row_type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer));
  } else if (is_attribute) {
    Check(H5Aread(object, memory_type, buffer));
  } else {
    Check(H5Dread(object, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer));
  }
}

std::vector<std::string> ReadTexts(const Hdf5Values& values) {
  return Check(H5Tis_variable_str(values.type)) > 0 ? ReadVariableTexts(values) : ReadFixedTexts(values);
}

std::vector<NamedValue> ReadNamedValues(const Hdf5Values& values) {
  const Hdf5Handle native(H5Tget_native_type(values.type, H5T_DIR_ASCEND), H5Tclose);
  const Hdf5Handle number_type(H5Tget_super(native.get()), H5Tclose);
  const std::size_t width = H5Tget_size(native.get());
  std::vector<std::byte> bytes(width * values.count);
  values.Read(native.get(), bytes.data());
  std::vector<NamedValue> named;
  for (std::size_t i = 0; i < values.count; ++i) {
    const std::byte* value = bytes.data() + i * width;
    char name[256] = "";
    if (H5Tenum_nameof(native.get(), value, name, sizeof name) < 0) name[0] = '\0';
    // H5Tconvert works in place and needs room for the wider type.
    std::byte number_bytes[sizeof(long long) * 2]{};
    if (width > sizeof(long long)) throw Hdf5Error("an enumeration is wider than 64 bits");
    std::memcpy(number_bytes, value, width);
    Check(H5Tconvert(number_type.get(), H5T_NATIVE_LLONG, 1, number_bytes, nullptr, H5P_DEFAULT));
    long long number{};
    std::memcpy(&number, number_bytes, sizeof number);
    named.push_back({name, number});
  }
  return named;
}

}  // namespace strainwave::daq
