// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/camera/picture_source.h"

#include <dlfcn.h>

#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>

#include "bench/installation.h"

namespace strainwave::bench {
namespace {

using Make = PictureSource*(const std::variant<int, std::string>&);

void* LoadModule() {
  const std::filesystem::path file = ModuleFile("strainwave_camera.so");
  if (void* const module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL)) return module;
  throw std::runtime_error(fmt::format(
      "the camera's module cannot be loaded (of the Debian package strainwave-camera, or of a build with "
      "libopencv-videoio-dev and libopencv-imgcodecs-dev): {}",
      ::dlerror()));
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
