// SPDX-License-Identifier: Apache-2.0
#include "daq/arrays_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <stdexcept>

#include "daq/data_file_error.h"
#include "daq/hdf5_handle.h"
#include "daq/hdf5_image.h"
#include "daq/hdf5_record.h"
#include "daq/record_error.h"
#include "daq/record_pipe.h"
#include "daq/whole_file.h"

namespace strainwave::daq {
namespace {

constexpr std::size_t kMostValues = std::size_t{1} << 28;  // 2 GiB; a damaged shape asks for more

std::size_t SizeOf(const std::vector<std::size_t>& shape) {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

// A product of extents may be any small number once it does not fit any more.
bool IsAtMost(const std::vector<std::size_t>& shape, std::size_t most) {
  if (std::ranges::find(shape, std::size_t{0}) != shape.end()) return true;
  for (const std::size_t extent : shape) {
    if (extent > most) return false;
    most /= extent;
  }
  return true;
}

void WriteArray(hid_t file, const NamedArray& array) {
  const std::vector<hsize_t> shape(array.shape.begin(), array.shape.end());
  const Hdf5Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  // Without the time of its making: the same content is the same file.
  const Hdf5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  Check(H5Pset_obj_track_times(creation.get(), false));
  const Hdf5Handle set(H5Dcreate2(file, array.name.c_str(), H5T_IEEE_F64LE, space.get(), H5P_DEFAULT,
                                  creation.get(), H5P_DEFAULT),
                       H5Dclose);
  Check(H5Dwrite(set.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, array.values.data()));
}

NamedArray ReadArray(hid_t file, const std::string& name, std::size_t& values_left) {
  const Hdf5Handle set(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
  const Hdf5Handle space(H5Dget_space(set.get()), H5Sclose);
  std::vector<hsize_t> shape(static_cast<std::size_t>(Check(H5Sget_simple_extent_ndims(space.get()))));
  Check(H5Sget_simple_extent_dims(space.get(), shape.data(), nullptr));
  NamedArray array{name, {shape.begin(), shape.end()}, {}};
  if (!IsAtMost(array.shape, values_left)) throw Hdf5Error(fmt::format("array '{}' is too large", name));
  array.values.resize(SizeOf(array.shape));
  values_left -= array.values.size();
  Check(H5Dread(set.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, array.values.data()));
  return array;
}

herr_t TakeName(hid_t, const char* name, const H5L_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->push_back(name);
  return 0;
}

}  // namespace

const NamedArray* ArraysFile::Find(std::string_view name) const {
  const auto found = std::ranges::find(arrays, name, &NamedArray::name);
  return found == arrays.end() ? nullptr : &*found;
}

void WriteArraysAtomically(const std::filesystem::path& path, const ArraysFile& file) {
  for (const NamedArray& array : file.arrays) {
    if (array.shape.empty() || SizeOf(array.shape) != array.values.size()) {
      throw std::invalid_argument(
          fmt::format("array '{}' has {} values (expected the product of its shape, {})", array.name,
                      array.values.size(), SizeOf(array.shape)));
    }
  }
  const Hdf5Silence silence;
  std::vector<std::byte> image;
  try {
    const Hdf5Handle built = CreateHdf5InMemory();
    WriteFileAttributes(built.get(), file.attributes);
    for (const NamedArray& array : file.arrays) WriteArray(built.get(), array);
    image = ImageOfHdf5(built.get());
  } catch (const Hdf5Error& error) {
    throw DataFileError(std::make_error_code(std::errc::io_error),
                        fmt::format("cannot build ({}) the HDF5 file", error.what()), path.string());
  }
  WriteFileAtomically(path, image);
}

namespace {

ArraysFile ReadArraysHere(const std::filesystem::path& path) {
  const Hdf5Silence silence;
  const Hdf5Handle file = OpenHdf5ForReading(path);
  try {
    ArraysFile read{.attributes = ReadFileAttributes(file.get()), .arrays = {}};
    std::vector<std::string> names;
    Check(H5Literate(file.get(), H5_INDEX_CRT_ORDER, H5_ITER_INC, nullptr, TakeName, &names));
    std::size_t values_left = kMostValues;
    for (const std::string& name : names) read.arrays.push_back(ReadArray(file.get(), name, values_left));
    return read;
  } catch (const Hdf5Error& error) {
    throw RecordError(path.string(), fmt::format("HDF5 cannot read the file: {}", error.what()),
                      "the arrays as they were written");
  }
}

}  // namespace

ArraysFile ReadArrays(const std::filesystem::path& path) {
  return ReadArraysInOwnProcess(path, LimitsForFile(path), [&path] { return ReadArraysHere(path); });
}

}  // namespace strainwave::daq
