// SPDX-License-Identifier: Apache-2.0
#include "bench/errors/output_path.h"

#include <system_error>

#include <fmt/format.h>

#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

// What is not there is of type not_found, also below a file.
fs::file_type TypeOf(const fs::path& path, const char* expected) {
  std::error_code failure;
  const fs::file_type type = fs::status(path, failure).type();
  if (type == fs::file_type::none || (failure && type != fs::file_type::not_found))
    Refuse(path, fmt::format("cannot be written: {}", failure.message()), expected);
  return type;
}

}  // namespace

void DemandOutputFolder(const fs::path& folder) {
  constexpr const char* kExpected = "a folder, there or to be made";
  if (folder.empty()) Refuse("''", "is no folder", kExpected);
  for (fs::path above = fs::absolute(folder).lexically_normal(); above.has_relative_path();
       above = above.parent_path()) {
    const fs::file_type type = TypeOf(above, kExpected);
    if (type == fs::file_type::directory) return;
    if (type == fs::file_type::not_found) continue;
    const fs::path named = folder.is_absolute() ? above : above.lexically_relative(fs::current_path());
    if (named == folder.lexically_normal()) Refuse(folder, "is no folder", kExpected);
    Refuse(folder, fmt::format("{} is no folder", named.string()), kExpected);
  }
}

void DemandFolderOf(const fs::path& file) {
  if (file.has_parent_path()) DemandOutputFolder(file.parent_path());
}

void DemandOutputFile(const fs::path& file) {
  constexpr const char* kExpected = "the name of a file to write";
  if (file.empty() || !file.has_filename()) Refuse(file.empty() ? "''" : file, "is no file", kExpected);
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (TypeOf(folder, kExpected) != fs::file_type::directory)
    Refuse(file, "its folder is not there", "a file in a folder that is");
  const fs::file_type type = TypeOf(file, kExpected);
  if (type != fs::file_type::regular && type != fs::file_type::not_found)
    Refuse(file, "is no file", kExpected);
}

}  // namespace strainwave::bench
