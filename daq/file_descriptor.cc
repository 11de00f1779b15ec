// SPDX-License-Identifier: Apache-2.0
#include "daq/file_descriptor.h"

#include <cerrno>

#include "daq/data_file_error.h"

namespace strainwave::daq {

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
