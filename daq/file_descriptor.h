// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <span>
#include <utility>

namespace strainwave::daq {

/// Owns a POSIX file descriptor; negative is none.
class FileDescriptor {
 public:
  explicit FileDescriptor(int fd) : fd_(fd) {}
  FileDescriptor(FileDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~FileDescriptor() {
    if (fd_ >= 0) ::close(fd_);
  }

  int get() const { return fd_; }
  bool is_open() const { return fd_ >= 0; }
  /// Closes now, so that an error which the kernel kept for close() is seen; the result of close().
  int Close() { return ::close(std::exchange(fd_, -1)); }

 private:
  int fd_;
};

/// Whether a path leads to what is open there; not, too, where one of the two cannot be asked.
bool LeadsTo(const std::filesystem::path& path, int fd) noexcept;

/// Writes all of it, however little the kernel takes at once.
/// @throws DataFileError "cannot write" with the path.
void WriteAll(int fd, std::span<const std::byte> bytes, const std::filesystem::path& path);

}  // namespace strainwave::daq
