// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cerrno>
#include <string>
#include <system_error>

namespace strainwave::daq {

/// The machine could not do what was asked with a file: no space, no permission, an I/O error, or a failure
/// inside the HDF5 library. `what()` reads "cannot write '/a/b.h5': No space left on device".
class DataFileError : public std::system_error {
 public:
  DataFileError(std::error_code code, std::string doing, std::string path)
      : std::system_error(code, doing + " '" + path + "'"), path_(std::move(path)) {}

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// What errno says.
inline std::error_code LastError() { return {errno, std::generic_category()}; }

}  // namespace strainwave::daq
