// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>

/// Where a test or a benchmark finds the checkout and the program that were built with it. Found when it
/// runs, so that its object files hold no folder, and a checkout elsewhere takes them from the compiler's
/// cache.
namespace strainwave {

/// The checkout that a build folder was made of, by the file `source_folder` that CMake writes into it.
/// @throws std::runtime_error where that file is missing or empty.
inline std::string SourceFolderOf(const std::filesystem::path& build) {
  std::ifstream file(build / "source_folder");
  std::string folder;
  if (!std::getline(file, folder) || folder.empty()) {
    throw std::runtime_error(
        (build / "source_folder").string() +
        " is missing or empty (expected the folder of the checkout; cmake --preset release "
        "writes it)");
  }
  return folder;
}

/// The build folder of this process: what is tested lies one folder below it.
inline std::filesystem::path BuildFolder() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path();
}

/// The checkout that this process was built of; without one, says so and exits.
inline const std::string& SourceFolder() {
  static const std::string folder = [] {
    try {
      return SourceFolderOf(BuildFolder());
    } catch (const std::exception& error) {
      std::cerr << "error: " << error.what() << '\n';
      std::exit(2);
    }
  }();
  return folder;
}

/// The program that was built beside this process.
inline const std::string& ProgramPath() {
  static const std::string program = BuildFolder() / "strainwave";
  return program;
}

}  // namespace strainwave
