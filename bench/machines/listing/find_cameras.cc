// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "bench/machines/listing/find_devices.h"

namespace strainwave::bench {
namespace {

std::string Text(const __u8* bytes, std::size_t most) {
  const auto* const end = std::find(bytes, bytes + most, __u8{0});
  return {bytes, end};
}

void Add(const std::filesystem::path& file, FoundPart& part) {
  const int device = ::open(file.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  v4l2_capability can{};
  const bool told = device >= 0 && ::ioctl(device, VIDIOC_QUERYCAP, &can) == 0;
  const int error = errno;
  if (device >= 0) ::close(device);
  if (!told) {
    part.notes.push_back(
        fmt::format("{} does not say what it is: {}", file.string(), std::system_category().message(error)));
    return;
  }
  // Of one camera several devices are made; those of metadata give no pictures.
  const auto abilities = (can.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? can.device_caps : can.capabilities;
  if ((abilities & (V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_VIDEO_CAPTURE_MPLANE)) == 0) return;
  FoundDevice found;
  found.where = file.string();
  found.what = Text(can.card, sizeof can.card);
  found.fields = {{"driver", Text(can.driver, sizeof can.driver)},
                  {"bus", Text(can.bus_info, sizeof can.bus_info)}};
  part.devices.push_back(std::move(found));
}

}  // namespace

FoundPart FindCameras() {
  FoundPart part{"camera", {}, {}};
  std::vector<std::filesystem::path> files;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", none)) {
    if (entry.path().filename().string().starts_with("video")) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  for (const auto& file : files) Add(file, part);
  if (part.devices.empty() && part.notes.empty()) {
    part.notes.emplace_back("there is no camera (no /dev/video* that gives pictures)");
  }
  return part;
}

}  // namespace strainwave::bench
