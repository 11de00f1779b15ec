// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/camera/picture_source.h"

#include <dlfcn.h>

#include <filesystem>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

namespace strainwave::bench {
namespace {

using Make = PictureSource*(const std::variant<int, std::string>&);

// Beside the program, as it is installed; else where it was built.
void* LoadModule() {
  std::error_code unreadable;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", unreadable);
  const std::filesystem::path built = STRAINWAVE_CAMERA_MODULE;
  for (const auto& file : {program.parent_path() / built.filename(), built}) {
    if (void* const module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL)) return module;
  }
  throw std::runtime_error(fmt::format("the camera's module cannot be loaded: {}", ::dlerror()));
}

}  // namespace

std::unique_ptr<PictureSource> MakePictureSource(const std::variant<int, std::string>& source) {
  static void* const module = LoadModule();  // stays until the program ends
  auto* const make = reinterpret_cast<Make*>(::dlsym(module, "StrainwaveMakePictureSource"));
  if (make == nullptr)
    throw std::runtime_error(fmt::format("the camera's module is another: {}", ::dlerror()));
  return std::unique_ptr<PictureSource>(make(source));
}

}  // namespace strainwave::bench
