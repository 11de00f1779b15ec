// SPDX-License-Identifier: Apache-2.0
#include "daq/import/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <system_error>

#include <fmt/format.h>

#include "daq/file_descriptor.h"
#include "daq/record_error.h"

namespace strainwave::daq {

MappedFile::MappedFile(const std::filesystem::path& path) {
  const auto fail = [&] {
    throw RecordError(path.string(),
                      fmt::format("cannot be read: {}", std::generic_category().message(errno)),
                      "a file that can be read");
  };
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat status {};
  if (file.get() < 0 || ::fstat(file.get(), &status) != 0) fail();
  if (!S_ISREG(status.st_mode)) throw RecordError(path.string(), "is no plain file", "a file");
  size_ = static_cast<std::size_t>(status.st_size);
  if (size_ == 0) return;
  void* const data = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file.get(), 0);
  if (data == MAP_FAILED) fail();
  ::madvise(data, size_, MADV_SEQUENTIAL);
  data_ = static_cast<const char*>(data);
}

MappedFile::~MappedFile() {
  if (data_ != nullptr) ::munmap(const_cast<char*>(data_), size_);
}

}  // namespace strainwave::daq
