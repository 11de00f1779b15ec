// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "bench/configuration/read_bench_file.h"

namespace strainwave::bench {

/// What a bench file of this text is refused with; empty where it is taken.
inline std::string BenchMessageOf(const std::string& text, std::string_view file,
                                  const std::filesystem::path& folder = {}) {
  try {
    ParseBenchFile(text, file, folder);
    return {};
  } catch (const BenchFileError& error) {
    return error.what();
  }
}

}  // namespace strainwave::bench
