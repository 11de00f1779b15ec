// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace strainwave::bench {

/// A folder of its own for files that are needed for a moment; gone with this. @throws std::system_error.
class ScratchFolder {
 public:
  ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder();
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The `<svg>` element of `stem`.svg as gnuplot wrote it, to stand within HTML: without prologue, name spaces
/// and size (it fills its place), and without names, which several pictures of one page would share, but for
/// those of its marks, which are alike in all.
/// @throws GnuplotError for a file that holds none.
std::string SvgText(const std::filesystem::path& stem);

}  // namespace strainwave::bench
