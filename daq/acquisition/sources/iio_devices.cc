// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/sources/iio_devices.h"

#include <cerrno>
#include <memory>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "daq/acquisition/sources/iio_handles.h"

namespace strainwave::daq::acquisition {
namespace {

void AddDevices(const std::string& uri, std::vector<IioDeviceInfo>& found,
                std::vector<std::string>& troubles) {
  const IioContext context = OpenIioContext(uri);
  if (!context) {
    troubles.push_back(
        fmt::format("the IIO context '{}' cannot be opened: {}", uri, std::system_category().message(errno)));
    return;
  }
  for (unsigned d = 0; d < iio_context_get_devices_count(context.get()); ++d) {
    const iio_device* const device = iio_context_get_device(context.get(), d);
    const char* const name = iio_device_get_name(device);
    IioDeviceInfo info{uri, name != nullptr ? name : iio_device_get_id(device), {}};
    for (unsigned c = 0; c < iio_device_get_channels_count(device); ++c) {
      const iio_channel* const channel = iio_device_get_channel(device, c);
      if (IsScanned(channel) && !IsIioTimeStamp(channel))
        info.channels.emplace_back(iio_channel_get_id(channel));
    }
    if (!info.channels.empty()) found.push_back(std::move(info));
  }
}

}  // namespace

std::vector<IioDeviceInfo> FindIioDevices(std::vector<std::string>& troubles) {
  std::vector<IioDeviceInfo> found;
  constexpr std::pair<const char*, const char*> kWays[] = {
      {"local", "this machine"}, {"usb", "USB"}, {"ip", "the network"}};
  // One after the other: where one way is not to be had, libiio gives up the others, too.
  for (const auto& [backend, words] : kWays) {
    const std::unique_ptr<iio_scan_context, decltype(&iio_scan_context_destroy)> scan(
        iio_create_scan_context(backend, 0), iio_scan_context_destroy);
    iio_context_info** list = nullptr;
    const ssize_t count = scan ? iio_scan_context_get_info_list(scan.get(), &list) : -errno;
    if (count < 0) {
      const auto error = static_cast<int>(-count);
      // Without sensors there is no such folder in /sys; that is nobody's trouble.
      if (error == ENOENT) continue;
      // On the network it is a number of avahi's, which is another thing to the system.
      troubles.push_back(
          std::string_view(backend) == "ip"
              ? "IIO devices on the network cannot be looked for: avahi does not answer (try: "
                "systemctl start avahi-daemon; of a device with an address: iio_info -u ip:ADDRESS)"
              : fmt::format("IIO devices on {} cannot be looked for: {}", words,
                            std::system_category().message(error)));
      continue;
    }
    for (ssize_t i = 0; i < count; ++i) AddDevices(iio_context_info_get_uri(list[i]), found, troubles);
    iio_context_info_list_free(list);
  }
  return found;
}

}  // namespace strainwave::daq::acquisition
