// SPDX-License-Identifier: Apache-2.0
#include "daq/whole_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
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

// Empty, and one writer's alone: the kernel lets go of its lock when the writer ends, however it ends.
// Removed on every way out but success.
class PartialFile {
 public:
  explicit PartialFile(const std::filesystem::path& target) {
    const std::string name = target.filename().string();
    path_ = target.parent_path() / fmt::format(".{}.partial", name);
    for (int others = 0; !Take();) path_.replace_filename(fmt::format(".{}.{}.partial", name, ++others));
  }
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  ~PartialFile() {
    // While the lock is still held.
    if (owned_) ::unlink(path_.c_str());
  }

  const std::filesystem::path& path() const { return path_; }
  int descriptor() const { return file_.get(); }
  void LetGo() { owned_ = false; }

 private:
  // Some file systems number a file anew each time that it is asked for: there the name must do.
  static constexpr int kMostLooks = 100;

  // False where another one writes it at this moment.
  bool Take() {
    for (int looks = 1;; ++looks) {
      file_ = FileDescriptor(::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666));
      if (!file_.is_open()) throw DataFileError(LastError(), "cannot create", path_.string());
      // A file system without locks has none to hold.
      if (::flock(file_.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return false;
      // Since it was opened its writer may have given it its place: by this name there is another, or none.
      if (!LeadsTo(path_, file_.get()) && looks < kMostLooks) continue;
      owned_ = true;
      struct stat held {};
      if (::fstat(file_.get(), &held) == 0 && held.st_size > 0 && ::ftruncate(file_.get(), 0) != 0)
        throw DataFileError(LastError(), "cannot create", path_.string());
      return true;
    }
  }

  std::filesystem::path path_;
  FileDescriptor file_{-1};
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
  WriteAll(partial.descriptor(), bytes, partial.path());
  // An fsync error is reported once and then forgotten by the kernel: it is final for this file.
  if (::fsync(partial.descriptor()) != 0)
    throw DataFileError(LastError(), "cannot sync", partial.path().string());
  // What close() would say, while the lock is still held.
  FileDescriptor copy(::dup(partial.descriptor()));
  if (copy.is_open() && copy.Close() != 0)
    throw DataFileError(LastError(), "cannot close", partial.path().string());
  if (::rename(partial.path().c_str(), path.c_str()) != 0) {
    throw DataFileError(LastError(), "cannot rename the finished file to", path.string());
  }
  partial.LetGo();
  SyncFolderOf(path);
}

void WriteFileAtomically(const std::filesystem::path& path, const std::string& text) {
  WriteFileAtomically(path, std::as_bytes(std::span(text)));
}

}  // namespace strainwave::daq
