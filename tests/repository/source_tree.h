// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "tests/checkout.h"

/// The files of this checkout, as the tests of the repository read them.
namespace strainwave::repository {

namespace fs = std::filesystem;

inline constexpr std::string_view kTopFolders[] = {"analysis",  "bench",     "daq",  "packaging",
                                                   "protocols", "schedules", "tests"};

struct SourceFile {
  std::string path;  // from the root of the checkout, with '/'
  std::vector<std::string> lines;
};

inline SourceFile ReadSource(const std::string& path) {
  SourceFile file{path, {}};
  std::ifstream stream(fs::path(SourceFolder()) / path, std::ios::binary);
  EXPECT_TRUE(stream) << path << " cannot be read";
  for (std::string line; std::getline(stream, line);) {
    file.lines.push_back(line);
  }
  return file;
}

/// All files below the top folders, cmake/, docs/ and .ci/, and those in the root itself, in the order of
/// their paths. Build folders and campaigns are no part of the tree.
inline std::vector<std::string> ListSources() {
  const fs::path root = SourceFolder();
  std::vector<std::string> paths;
  const auto add = [&](const fs::directory_entry& entry) {
    if (entry.is_regular_file() && entry.path().extension() != ".pyc") {
      paths.push_back(fs::relative(entry.path(), root).generic_string());
    }
  };
  for (const fs::directory_entry& entry : fs::directory_iterator(root)) {
    add(entry);
  }
  std::vector<std::string_view> folders(std::begin(kTopFolders), std::end(kTopFolders));
  folders.insert(folders.end(), {"cmake", "docs", ".ci"});
  for (const std::string_view folder : folders) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder)) {
      add(entry);
    }
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

inline bool HasSuffix(std::string_view path, std::string_view suffix) { return path.ends_with(suffix); }

inline bool IsCpp(std::string_view path) { return HasSuffix(path, ".h") || HasSuffix(path, ".cc"); }

inline std::string FolderOf(std::string_view path) { return std::string(path.substr(0, path.find('/'))); }

}  // namespace strainwave::repository
