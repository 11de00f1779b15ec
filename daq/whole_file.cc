// SPDX-License-Identifier: Apache-2.0
#include "daq/whole_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>

#include "daq/data_file_error.h"
#include "daq/file_descriptor.h"
#include "daq/record_error.h"
#include "daq/record_limits.h"
#include "daq/synced_folder.h"

namespace strainwave::daq {
namespace {

[[noreturn]] void ThrowUnreadable(const std::filesystem::path& path) {
  throw RecordError(path.string(), LastError().message(), "a record file");
}

// Removes the partial file on every way out but success.
class PartialFile {
 public:
  explicit PartialFile(const std::filesystem::path& target)
      : path_(target.parent_path() / fmt::format(".{}.partial", target.filename().string())) {}
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  ~PartialFile() {
    if (owned_) ::unlink(path_.c_str());
  }

  const std::filesystem::path& path() const { return path_; }
  void set_owned(bool owned) { owned_ = owned; }

 private:
  std::filesystem::path path_;
  bool owned_ = false;
};

}  // namespace

std::string ReadWholeFile(const std::filesystem::path& path) {
  const auto demand_size = [&path](std::uintmax_t bytes) {
    if (bytes <= kMostText_bytes) return;
    throw RecordError(path.string(), fmt::format("the file has more than {} bytes", kMostText_bytes),
                      "a smaller one: a part of the time, or HDF5");
  };
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) ThrowUnreadable(path);
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) ThrowUnreadable(path);
  // A pipe is a file to read from; a device such as /dev/zero never ends.
  if (S_ISCHR(status.st_mode) || S_ISBLK(status.st_mode)) {
    throw RecordError(path.string(), "is a device", "a record file");
  }
  demand_size(static_cast<std::uintmax_t>(status.st_size));
  std::string text;
  if (status.st_size > 0) text.reserve(static_cast<std::size_t>(status.st_size) + 1);
  std::size_t filled = 0;
  while (true) {
    // One byte more than is known to come, so that the end of a plain file is seen without growing.
    text.resize(std::max(text.capacity(), filled + 65536));
    const ssize_t got = ::read(file.get(), text.data() + filled, text.size() - filled);
    if (got < 0) {
      if (errno == EINTR) continue;
      ThrowUnreadable(path);
    }
    filled += static_cast<std::size_t>(got);
    demand_size(filled);
    if (got == 0) break;
  }
  text.resize(filled);
  return text;
}

void WriteFileAtomically(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  PartialFile partial(path);
  FileDescriptor file(::open(partial.path().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (!file.is_open()) throw DataFileError(LastError(), "cannot create", partial.path().string());
  partial.set_owned(true);
  WriteAll(file.get(), bytes, partial.path());
  // An fsync error is reported once and then forgotten by the kernel: it is final for this file.
  if (::fsync(file.get()) != 0) throw DataFileError(LastError(), "cannot sync", partial.path().string());
  if (file.Close() != 0) throw DataFileError(LastError(), "cannot close", partial.path().string());
  if (::rename(partial.path().c_str(), path.c_str()) != 0) {
    throw DataFileError(LastError(), "cannot rename the finished file to", path.string());
  }
  partial.set_owned(false);
  SyncFolderOf(path);
}

void WriteFileAtomically(const std::filesystem::path& path, const std::string& text) {
  WriteFileAtomically(path, std::as_bytes(std::span(text)));
}

}  // namespace strainwave::daq
