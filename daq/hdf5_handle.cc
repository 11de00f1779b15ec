// SPDX-License-Identifier: Apache-2.0
#include "daq/hdf5_handle.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <new>
#include <system_error>

#include "daq/file_descriptor.h"
#include "daq/record_error.h"

namespace strainwave::daq {
namespace {

herr_t KeepFirst(unsigned depth, const H5E_error2_t* entry, void* text) {
  if (depth == 0 && entry->desc != nullptr) *static_cast<std::string*>(text) = entry->desc;
  return 0;
}

// The library would say "unable to open file" for each of these.
void DemandReadableFile(const std::string& path) {
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat status {};
  if (!file.is_open() || ::fstat(file.get(), &status) != 0) {
    throw RecordError(path, std::generic_category().message(errno), "a record file");
  }
  if (S_ISDIR(status.st_mode)) {
    throw RecordError(path, std::generic_category().message(EISDIR), "a record file");
  }
  if (status.st_size == 0) throw RecordError(path, "the file is empty", "an HDF5 file");
}

}  // namespace

Hdf5Silence::Hdf5Silence() {
  // After a damaged file the library complains on standard error when the process ends, about what it could
  // not close in itself. All files are closed by their handles, so its own tidying up is not needed.
  static const herr_t once = H5dont_atexit();
  static_cast<void>(once);
  H5Eget_auto2(H5E_DEFAULT, &printer_, &printer_data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Hdf5Silence::~Hdf5Silence() { H5Eset_auto2(H5E_DEFAULT, printer_, printer_data_); }

std::string Hdf5ErrorText() {
  std::string text = "HDF5 does not say why";
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, KeepFirst, &text);
  return text;
}

void DemandMemoryForHdf5() {
  constexpr std::size_t kOfOneFile_bytes = 4 << 20;  // 0.6 MB its cache of metadata, 1 MB its cache of chunks
  ::operator delete(::operator new(kOfOneFile_bytes));
}

Hdf5Handle OpenHdf5ForReading(const std::filesystem::path& path) {
  DemandMemoryForHdf5();
  const std::string name = path.string();
  DemandReadableFile(name);
  if (H5Fis_hdf5(name.c_str()) <= 0) throw RecordError(name, "not an HDF5 file", "an HDF5 file");
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  Check(H5Pset_file_locking(access.get(), false, true));
  try {
    return {H5Fopen(name.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose};
  } catch (const Hdf5Error& error) {
    unsigned long long present{}, base{}, whole{};
    if (std::sscanf(error.what(), "truncated file: eof = %llu, sblock->base_addr = %llu, stored_eof = %llu",
                    &present, &base, &whole) == 3) {
      throw RecordError(
          name, fmt::format("not a complete HDF5 file (truncated: {} of {} bytes)", present, base + whole),
          "the file as it was written");
    }
    throw RecordError(name, fmt::format("HDF5 cannot open the file: {}", error.what()),
                      "the file as it was written");
  }
}

}  // namespace strainwave::daq
