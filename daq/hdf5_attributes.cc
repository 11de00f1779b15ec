// SPDX-License-Identifier: Apache-2.0
#include "daq/hdf5_attributes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "daq/hdf5_handle.h"
#include "daq/hdf5_text.h"
#include "daq/record.h"
#include "daq/record_limits.h"
#include "daq/software.h"

namespace strainwave::daq {
namespace {

void WriteScalar(hid_t object, const std::string& name, hid_t file_type, hid_t memory_type,
                 const void* value) {
  const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Handle attribute(
      H5Acreate2(object, name.c_str(), file_type, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  Check(H5Awrite(attribute.get(), memory_type, value));
}

H5_index_t AttributeIndex(hid_t object) {
  const bool is_group = H5Iget_type(object) == H5I_GROUP;
  const Hdf5Handle list(is_group ? H5Gget_create_plist(object) : H5Dget_create_plist(object), H5Pclose);
  unsigned flags{};
  Check(H5Pget_attr_creation_order(list.get(), &flags));
  return IndexFor(flags);
}

herr_t TakeName(hid_t, const char* name, const H5A_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->push_back(name);
  return 0;
}

std::string TextOfNumber(const Hdf5Values& values, H5T_class_t type_class) {
  if (type_class == H5T_FLOAT) {
    if (H5Tget_size(values.type) <= sizeof(float)) {
      float number{};
      values.Read(H5T_NATIVE_FLOAT, &number);
      return ShortestText(number);
    }
    double number{};
    values.Read(H5T_NATIVE_DOUBLE, &number);
    return ShortestText(number);
  }
  if (H5Tget_sign(values.type) == H5T_SGN_NONE) {
    unsigned long long number{};
    values.Read(H5T_NATIVE_ULLONG, &number);
    return std::to_string(number);
  }
  long long number{};
  values.Read(H5T_NATIVE_LLONG, &number);
  return std::to_string(number);
}

std::optional<Hdf5Attribute> ReadAttribute(hid_t attribute, const std::string& name) {
  const Hdf5Handle space(H5Aget_space(attribute), H5Sclose);
  if (Check(H5Sget_simple_extent_npoints(space.get())) != 1) return std::nullopt;
  const Hdf5Handle type(H5Aget_type(attribute), H5Tclose);
  if (H5Tget_size(type.get()) > kMostLine_bytes) return std::nullopt;
  const Hdf5Values values{type.get(), space.get(), 1, true, attribute};
  const H5T_class_t type_class = H5Tget_class(type.get());
  if (type_class == H5T_STRING) return Hdf5Attribute{name, ReadTexts(values).front()};
  if (type_class == H5T_FLOAT || type_class == H5T_INTEGER) {
    return Hdf5Attribute{name, TextOfNumber(values, type_class)};
  }
  if (type_class != H5T_ENUM) return std::nullopt;
  const NamedValue value = ReadNamedValues(values).front();
  if (value.name == "TRUE" || value.name == "FALSE") {
    return Hdf5Attribute{name, value.name == "TRUE" ? "true" : "false"};
  }
  return Hdf5Attribute{name, value.name.empty() ? std::to_string(value.number) : value.name};
}

}  // namespace

void WriteTextAttribute(hid_t object, const std::string& name, const std::string& text) {
  // Fixed in length, so that it stands in the object header, under its checksum. Texts of variable length
  // stand in a heap without one, where a flipped bit can even send the library round for ever.
  const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  Check(H5Tset_size(type.get(), std::max<std::size_t>(text.size(), 1)));
  Check(H5Tset_strpad(type.get(), H5T_STR_NULLPAD));
  Check(H5Tset_cset(type.get(), H5T_CSET_UTF8));
  WriteScalar(object, name, type.get(), type.get(), text.c_str());
}

void KeepAttributesInHeader(hid_t creation_properties, std::size_t attributes) {
  constexpr std::size_t kLibraryKeeps = 8;
  constexpr std::size_t kMost = 65535;
  if (attributes <= kLibraryKeeps) return;  // a header that says nothing of it is smaller
  const auto kept = static_cast<unsigned>(std::min(attributes, kMost));
  Check(H5Pset_attr_phase_change(creation_properties, kept, kept));
}

void WriteSoftware(hid_t file) { WriteTextAttribute(file, kSoftwareName, std::string(Software())); }

void WriteAttribute(hid_t object, const std::string& name, const std::string& text) {
  const std::optional<double> number = NumberFromText(text);
  if (!number || !std::isfinite(*number) || ShortestText(*number) != text) {
    WriteTextAttribute(object, name, text);
  } else {
    WriteScalar(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &*number);
  }
}

std::vector<Hdf5Attribute> ReadAttributes(hid_t object, std::vector<std::string>& left_out) {
  const H5_index_t index = AttributeIndex(object);
  H5O_info_t info{};
  Check(H5Oget_info2(object, &info, H5O_INFO_NUM_ATTRS));
  if (info.num_attrs > kMostMetadata) {
    throw Hdf5Error(fmt::format("an object has {} attributes (at most {})", info.num_attrs, kMostMetadata));
  }
  // Names first, in one walk: to open the n-th takes a walk each.
  std::vector<std::string> names;
  Check(H5Aiterate2(object, index, H5_ITER_INC, nullptr, TakeName, &names));
  std::vector<Hdf5Attribute> attributes;
  for (const std::string& name : names) {
    const Hdf5Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose);
    if (std::optional<Hdf5Attribute> read = ReadAttribute(attribute.get(), name)) {
      attributes.push_back(std::move(*read));
    } else {
      left_out.push_back(name);
    }
  }
  return attributes;
}

}  // namespace strainwave::daq
