// SPDX-License-Identifier: Apache-2.0
#include "bench/installation.h"

#include <system_error>

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

fs::path ProgramFolder() {
  std::error_code unreadable;
  return fs::read_symlink("/proc/self/exe", unreadable).parent_path();
}

bool IsThere(const fs::path& file) {
  std::error_code unreadable;
  return fs::exists(file, unreadable);
}

}  // namespace

fs::path ModuleFile(const char* name) {
  const fs::path program = ProgramFolder();
  const fs::path installed = (program / STRAINWAVE_TO_MODULES / name).lexically_normal();
  for (const fs::path& file : {installed, program / name, program.parent_path() / name}) {
    if (IsThere(file)) return file;
  }
  return installed;
}

fs::path DataFile(const char* name) {
  const fs::path installed = (ProgramFolder() / STRAINWAVE_TO_DATA / name).lexically_normal();
  return IsThere(installed) ? installed : fs::path(name);
}

}  // namespace strainwave::bench
