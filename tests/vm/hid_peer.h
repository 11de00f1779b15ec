// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <poll.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tests/vm/uhid_device.h"

namespace strainwave::bench {

/// A HID device made of the kernel's uhid: plugged in as long as it lives. Needs /dev/uhid.
class HidPeer {
 public:
  /// Reports of `report_bytes` bytes in and out, without numbers.
  HidPeer(std::uint16_t vendor, std::uint16_t product, const std::string& serial, std::uint8_t report_bytes)
      : device_("strainwave peer", vendor, product, serial,
                std::to_array<std::uint8_t>({0x06, 0x00, 0xFF,        // usage page: the maker's own
                                             0x09, 0x01, 0xA1, 0x01,  // usage 1, collection: application
                                             0x15, 0x00, 0x26, 0xFF,         0x00,
                                             0x75, 0x08, 0x95, report_bytes,  // bytes from 0 to 255, so many
                                             0x09, 0x01, 0x81, 0x02,          // input
                                             0x09, 0x02, 0x91, 0x02,          // output
                                             0xC0})) {}

  bool made() const { return device_.made(); }

  bool Send(std::span<const std::uint8_t> report) { return device_.SendReport(report); }

  /// The next output report that somebody sends to the device, or nothing within the time.
  std::vector<std::uint8_t> Take(std::chrono::milliseconds longest) {
    const auto end = std::chrono::steady_clock::now() + longest;
    for (;;) {
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
      pollfd waited{device_.file(), POLLIN, 0};
      uhid_event event{};
      if (left.count() <= 0 || ::poll(&waited, 1, static_cast<int>(left.count())) <= 0) return {};
      if (::read(device_.file(), &event, sizeof(event)) <= 0) return {};
      if (event.type != UHID_OUTPUT) continue;
      return {event.u.output.data, event.u.output.data + event.u.output.size};
    }
  }

 private:
  UhidDevice device_;
};

}  // namespace strainwave::bench
