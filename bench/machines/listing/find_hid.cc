// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include <fmt/format.h>

#include "bench/devices/hid/hid_device.h"
#include "bench/machines/listing/find_devices.h"

namespace strainwave::bench {

FoundPart FindHid(const KnownProfiles& known) {
  FoundPart part{"hid", {}, {}};
  for (const FoundHidDevice& device : FindHidDevices()) {
    FoundDevice found;
    found.where = device.path;
    found.what = fmt::format("{:04x}:{:04x} {} {}", device.vendor, device.product, device.maker, device.name);
    found.fields = {{"vendor", fmt::format("{:04x}", device.vendor)},
                    {"product", fmt::format("{:04x}", device.product)},
                    {"serial", device.serial},
                    {"maker", device.maker},
                    {"name", device.name}};
    for (const auto& [file, profile] : known.hid) {
      const HidSettings& wanted = profile.device;
      const bool fits = wanted.vendor == device.vendor && wanted.product == device.product &&
                        (wanted.serial.empty() || wanted.serial == device.serial);
      if (fits) found.profile = file.string();
    }
    part.devices.push_back(std::move(found));
  }
  if (!part.devices.empty()) return part;
  std::error_code none;
  part.notes.emplace_back(
      std::filesystem::exists("/sys/class/hidraw", none)
          ? "no HID device is plugged in, or this user may not open it (udev rules give /dev/hidraw* away)"
          : "this kernel has no hidraw (try: modprobe hid-generic usbhid)");
  return part;
}

}  // namespace strainwave::bench
