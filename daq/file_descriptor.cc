// SPDX-License-Identifier: Apache-2.0
#include "daq/file_descriptor.h"

#include <sys/stat.h>

#include <cerrno>

#include "daq/data_file_error.h"

namespace strainwave::daq {

bool LeadsTo(const std::filesystem::path& path, int fd) noexcept {
  struct stat held {};
  struct stat named {};
  return ::fstat(fd, &held) == 0 && ::stat(path.c_str(), &named) == 0 && held.st_dev == named.st_dev &&
         held.st_ino == named.st_ino;
}

void WriteAll(int fd, std::span<const std::byte> bytes, const std::filesystem::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      throw DataFileError(LastError(), "cannot write", path.string());
    }
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

}  // namespace strainwave::daq
