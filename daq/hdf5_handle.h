// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hdf5.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

/// The C API of HDF5 with owners and exceptions. Only the files of this folder that speak HDF5 include this.
namespace strainwave::daq {

/// A call into HDF5 that failed; `what()` is what the library says about it, without place or file. The faces
/// of this folder turn it into RecordError (reading) or DataFileError (writing).
class Hdf5Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Keeps HDF5 from printing its errors on standard error, in this thread, while it lives.
class Hdf5Silence {
 public:
  Hdf5Silence();
  Hdf5Silence(const Hdf5Silence&) = delete;
  Hdf5Silence& operator=(const Hdf5Silence&) = delete;
  ~Hdf5Silence();

 private:
  H5E_auto2_t printer_{};
  void* printer_data_{};
};

/// The innermost entry of HDF5's error stack, which names the cause; the outer ones name only the callers.
std::string Hdf5ErrorText();

/// @throws Hdf5Error if `result`, the return of an HDF5 call, is negative.
template <typename Result>
Result Check(Result result) {
  if (result < 0) throw Hdf5Error(Hdf5ErrorText());
  return result;
}

/// Owns an HDF5 identifier.
class Hdf5Handle {
 public:
  using Close = herr_t (*)(hid_t);

  /// @throws Hdf5Error if `id` is negative.
  Hdf5Handle(hid_t id, Close close) : id_(Check(id)), close_(close) {}
  Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Hdf5Handle& operator=(Hdf5Handle&&) = delete;
  ~Hdf5Handle() {
    if (id_ >= 0) close_(id_);
  }

  hid_t get() const { return id_; }

 private:
  hid_t id_;
  Close close_;
};

/// Opens a file for reading; it is never locked, so that a live campaign can be read.
/// @throws RecordError if it is missing, unreadable, not HDF5, cut short, or otherwise not to be opened.
Hdf5Handle OpenHdf5ForReading(const std::filesystem::path& path);

/// Asks for the memory that an open file takes, and gives it back: without it the library crashes (1.10.8,
/// H5AC_create), where it should say so. Before each file that is opened or made.
/// @throws std::bad_alloc
void DemandMemoryForHdf5();

}  // namespace strainwave::daq
