// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/checkout.h"

namespace strainwave::bench {

/// Where the bench file is, and those that it names.
inline std::filesystem::path Folder() {
  return std::filesystem::path(SourceFolder()) / "tests/simulation/field";
}

inline std::string BenchText() {
  std::ifstream file(Folder() / "bench.yaml");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace strainwave::bench
