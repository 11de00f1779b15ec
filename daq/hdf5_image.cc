// SPDX-License-Identifier: Apache-2.0
#include "daq/hdf5_image.h"

#include <fmt/format.h>

#include <atomic>

#include "daq/hdf5_attributes.h"

namespace strainwave::daq {
namespace {

constexpr std::size_t kMemoryStep = std::size_t{1} << 20;

}  // namespace

Hdf5Handle CreateHdf5InMemory() {
  DemandMemoryForHdf5();
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  Check(H5Pset_fapl_core(access.get(), kMemoryStep, false));
  // A superblock of version 2: the next one says "open for writing" until it is closed.
  Check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_V18, H5F_LIBVER_V18));
  const Hdf5Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  Check(H5Pset_link_creation_order(creation.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
  Check(H5Pset_attr_creation_order(creation.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
  Check(H5Pset_obj_track_times(creation.get(), false));
  // The library takes two open files of one name for the same one, also in memory.
  static std::atomic<unsigned> number{};
  const std::string name = fmt::format("in_memory_{}.h5", ++number);
  Hdf5Handle file(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, creation.get(), access.get()), H5Fclose);
  // From 1.10 on the index of chunks carries a checksum as everything else does; before, a flipped bit in it
  // could read as another value.
  Check(H5Fset_libver_bounds(file.get(), H5F_LIBVER_V110, H5F_LIBVER_V110));
  WriteSoftware(file.get());
  return file;
}

// H5Fget_file_image would clear the flags of the superblock without renewing its checksum (1.10), which makes
// a file that cannot be opened; the driver's own memory is the file as it stands after a flush.
std::vector<std::byte> ImageOfHdf5(hid_t file) {
  Check(H5Fflush(file, H5F_SCOPE_GLOBAL));
  const ssize_t size = Check(H5Fget_file_image(file, nullptr, 0));  // without the room the driver keeps
  void* memory{};
  Check(H5Fget_vfd_handle(file, H5P_DEFAULT, &memory));
  const auto* const bytes = *static_cast<const std::byte* const*>(memory);
  return {bytes, bytes + size};
}

}  // namespace strainwave::daq
