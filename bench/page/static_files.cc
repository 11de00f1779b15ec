// SPDX-License-Identifier: Apache-2.0
#include "bench/page/static_files.h"

#include <algorithm>

namespace strainwave::bench {

const StaticFile* FindStaticFile(std::string_view path) {
  const auto files = StaticFiles();
  const auto found = std::ranges::find(files, path, &StaticFile::path);
  return found == files.end() ? nullptr : &*found;
}

}  // namespace strainwave::bench
